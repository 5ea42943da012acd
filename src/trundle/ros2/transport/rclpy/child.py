"""The part of the bridge that runs in the user's ROS: it relays the bytes of topics, services and actions.

`link.py` starts it as a separate program, with the Python of the sourced ROS: Python 3.10 or later, any
distribution from Humble on, any RMW. That Python need not have trundle, so this file imports nothing of trundle,
and is long for that reason. It imports ROS only once it runs, so that trundle can import the protocol from it.

The protocol: frames over a Unix socket, each a header (`HEADER`: length of the payload, kind, number) and its
payload. Messages go through as their CDR bytes; everything else is JSON.
"""

# ROS is not there where trundle is developed.
# pyright: reportMissingImports=false

from __future__ import annotations

import contextlib
import ctypes
import importlib
import importlib.metadata
import itertools
import json
import os
import pathlib
import queue
import signal
import socket
import struct
import sys
import threading
import time
import uuid
from collections import deque

HEADER = struct.Struct("<IBI")
NUMBER = struct.Struct("<I")
LIMIT = 1 << 28
"""The longest payload [bytes]. Nothing that trundle sends or understands is longer."""

# To the child; the number is that of the call, publisher, question or goal.
CALL, PUBLISH, ANSWER, FEEDBACK, RESULT = range(1, 6)
# To trundle; the number is that of the call, subscription, question or goal.
HELLO, REFUSED, REPLY, SAMPLE, REQUEST, GOAL, STARTED, CANCEL, COUNTS, NOTE = range(16, 26)

SUCCEEDED, ABORTED, CANCELED = range(3)
"""How a goal ends: the first byte of RESULT."""

MAX_GOALS = 32
"""So many goals may be unfinished at a time; more are rejected."""

PATIENCE_S = 0.05
LEAVING_S = 1.2
CANCELING_S = 2.0
COUNTS_EVERY_S = 0.2
LOOKS_NS, QUIET_NS = 100_000_000, 20_000_000
"""Topics are looked at this often at least; the second where some have messages that wake nobody."""

GATHERS_S = 0.001
"""What comes so soon after a message that wakes somebody goes with it [s], as the scans of two lidars do."""

MARKS_S = 2.0
"""So long is waited at most for ROS to know a node's own endpoints [s]."""

PARTICIPANT = 24
"""Hex digits of a GUID of DDS that are those of its participant."""

MOST_AT_ONCE = 50
"""So many messages of a topic are taken before it is the turn of the next."""

# Both sides ----------------------------------------------------------------------------------------------------------


class Stream:
    """The messages of one topic that wait to be sent: the newest `depth`, in order.

    Args:
        kind: Kind of their frames.
        number: Number of their frames.
        depth: How many may wait.
        patient: Whether a writer waits a moment for room before the oldest is dropped.
    """

    def __init__(self, kind, number, depth, patient=False):
        self.kind, self.number, self.depth, self.patient = kind, number, max(depth, 1), patient
        self.waiting = deque()
        self.size = self.dropped = 0

    def is_full(self, size):
        """Return whether one more message of `size` bytes is too much."""
        return len(self.waiting) >= self.depth or (bool(self.waiting) and self.size + size > LIMIT)


class Outbox:
    """Sends frames in order, without ever making its callers wait for long.

    A frame goes straight to the socket while the socket takes it; otherwise it waits here, and a thread sends it. Of
    a topic's messages only the newest wait.
    """

    def __init__(self, sock):
        self._sock = sock
        self._changed = threading.Condition()
        self._frames = deque()  # of bytes, and of streams, each of which has its oldest message sent
        self._is_sending = self._is_closed = False
        self._is_stalled = False  # a patient stream has waited in vain, and waits no more until all is sent
        threading.Thread(target=self._send_waiting, name="ros2 outbox", daemon=True).start()

    def put(self, kind, number=0, payload=b""):
        """Send a frame."""
        frame = HEADER.pack(len(payload), kind, number) + payload
        with self._changed:
            if self._is_closed:
                return
            if self._frames or self._is_sending:
                self._frames.append(frame)
            else:
                self._send_now(frame)

    def put_message(self, stream, payload):
        """Send a message of a topic; where too many of them wait, the oldest are dropped and counted."""
        if len(payload) > LIMIT:
            stream.dropped += 1
            return
        frame = HEADER.pack(len(payload), stream.kind, stream.number) + payload
        with self._changed:
            if self._is_closed:
                return
            if not self._frames and not self._is_sending:
                self._send_now(frame)
                return
            if stream.patient and stream.is_full(len(frame)) and not self._is_stalled:
                self._is_stalled = not self._changed.wait_for(
                    lambda: self._is_closed or not stream.is_full(len(frame)), PATIENCE_S
                )
            while stream.is_full(len(frame)):  # one less waits, but the stream has still its turns for the others
                stream.size -= len(stream.waiting.popleft())
                stream.dropped += 1
                self._frames.remove(stream)
            stream.waiting.append(frame)
            stream.size += len(frame)
            self._frames.append(stream)
            self._changed.notify_all()

    def put_messages(self, messages):
        """Send messages of topics, each with its stream.

        They are one write where nothing waits and none of them is too long; what the socket does not take of that waits
        as a whole. Otherwise each is sent as by `put_message`.
        """
        with self._changed:
            if not self._frames and not self._is_sending and not self._is_closed:
                frames = [
                    HEADER.pack(len(payload), stream.kind, stream.number) + payload
                    for stream, payload in messages
                    if len(payload) <= LIMIT
                ]
                if len(frames) == len(messages):
                    self._send_now(b"".join(frames))
                    return
        for stream, payload in messages:
            self.put_message(stream, payload)

    def flush(self, timeout_s):
        """Wait until all is sent, but no longer than this."""
        with self._changed:
            self._changed.wait_for(lambda: self._is_closed or not (self._frames or self._is_sending), timeout_s)

    def close(self):
        """Send nothing more."""
        with self._changed:
            self._is_closed = True
            self._frames.clear()
            self._changed.notify_all()

    def _send_now(self, frame):
        try:
            sent = self._sock.send(frame, socket.MSG_DONTWAIT)
        except BlockingIOError:
            sent = 0
        except OSError:  # the other side is gone; whoever reads the socket reports it
            self._is_closed = True
            return
        if sent < len(frame):
            self._frames.append(memoryview(frame)[sent:])
            self._changed.notify_all()

    def _send_waiting(self):
        while True:
            with self._changed:
                self._is_sending = False
                if not self._frames:
                    self._is_stalled = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._frames or self._is_closed)
                if self._is_closed:
                    return
                frame = self._frames.popleft()
                if isinstance(frame, Stream):
                    stream, frame = frame, frame.waiting.popleft()
                    stream.size -= len(frame)
                self._is_sending = True
            try:
                self._sock.sendall(frame)
            except OSError:
                self.close()
                return


class BrokenStreamError(Exception):
    """What arrived is not of the protocol."""


def read_frames(sock):
    """Yield (kind, number, payload) until the other side closes the socket.

    Raises:
        BrokenStreamError: If a frame is longer than any may be.
    """
    with sock.makefile("rb", buffering=1 << 16) as reader:
        while True:
            header = reader.read(HEADER.size)
            if len(header) < HEADER.size:
                return
            length, kind, number = HEADER.unpack(header)
            if length > LIMIT:
                raise BrokenStreamError(f"a frame of {length} bytes, where {LIMIT} are allowed")
            payload = reader.read(length)
            if len(payload) < length:
                return
            yield kind, number, payload


# Types ---------------------------------------------------------------------------------------------------------------


class RefusedError(Exception):
    """Something that this ROS cannot do; the message says why."""


def load_kind(name):
    """Import the class of `package/msg/Name`, of a service or action, or of a part: `package/srv/Name_Request`."""
    package, _, rest = name.partition("/")
    folder, _, last = rest.partition("/")
    if folder not in ("msg", "srv", "action") or not last.isidentifier():
        raise RefusedError(f"{name!r} is not the name of a type, such as std_msgs/msg/String")
    try:
        module = importlib.import_module(f"{package}.{folder}")
    except ImportError as error:
        apt = f"ros-{os.environ.get('ROS_DISTRO', '<distro>')}-{package.replace('_', '-')}"
        raise RefusedError(f"this ROS has no {package} ({error}): apt install {apt}") from None
    if folder == "msg" or hasattr(module, last):
        kind = getattr(module, last, None)
    else:
        whole, _, part = last.rpartition("_")
        kind = getattr(getattr(module, whole, None), part, None)
    if kind is None:
        raise RefusedError(f"{package} of this ROS has no {last}")
    return kind


_PLAIN = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}


def _as_field(kind):
    """Return a type as rclpy writes it, as a .msg file writes it: `sequence<double, 3>` is `float64[<=3]`."""
    if kind.startswith("sequence<"):
        inner, _, bound = kind[len("sequence<") : -1].partition(", ")
        return f"{_as_field(inner)}[<={bound}]" if bound else f"{_as_field(inner)}[]"
    if kind.endswith("]"):
        inner, _, count = kind.rpartition("[")
        return f"{_as_field(inner)}[{count}"
    if kind.startswith(("string<", "wstring<")):
        inner, _, bound = kind[:-1].partition("<")
        return f"{inner}<={bound}"
    return _PLAIN.get(kind, kind)


def _constants(kind):
    """Return the constants of a message, as lines of its text; their widths are not known here and matter to nobody."""
    names = {bool: "bool", int: "int64", float: "float64", str: "string"}
    values = getattr(type(kind), f"_{type(kind).__name__}__constants", {})
    return [
        f"{names[type(value)]} {name}={json.dumps(value) if isinstance(value, str) else value}"
        for name, value in values.items()
        if type(value) in names
    ]


def _text(kind):
    fields = kind.get_fields_and_field_types()
    lines = [f"{_as_field(field)} {name}" for name, field in fields.items()]
    # An empty structure has one byte on the wire.
    return "\n".join([*_constants(kind), *(lines or ["uint8 structure_needs_at_least_one_member"])])


def _parts(kind):
    """Return the types of a message's fields that are messages."""
    for field in kind.get_fields_and_field_types().values():
        plain = field[len("sequence<") : -1].partition(", ")[0] if field.startswith("sequence<") else field
        package, slash, name = plain.partition("[")[0].partition("/")
        if slash:
            yield f"{package}/msg/{name}"


def define(name):
    """Make the text of a message and of those in it, as a bag's schema has it, from the classes that ROS uses."""
    texts, ahead = {}, [name]
    while ahead:
        next_name = ahead.pop(0)
        if next_name not in texts:
            kind = load_kind(next_name)
            texts[next_name] = _text(kind)
            ahead.extend(_parts(kind))
    first = texts.pop(name)
    separator = "\n" + 80 * "=" + "\nMSG: "
    return first + "".join(separator + part.replace("/msg/", "/") + "\n" + text for part, text in texts.items())


# The relay -----------------------------------------------------------------------------------------------------------


class Goal:
    """A goal that was accepted and is not finished."""

    def __init__(self, number, handle, kind):
        self.number, self.handle, self.kind = number, handle, kind
        self.end = queue.SimpleQueue()


class Topics:
    """Takes the messages of a node's topics, in a thread of its own.

    An executor of rclpy looks at all services and actions of the node whenever a message arrives, and hands it to
    another thread: several times the work.

    Args:
        context: The context of the node.
        outbox: Where the messages go.
        report: Called with what goes wrong.
    """

    def __init__(self, context, outbox, report):
        from rclpy.callback_groups import ReentrantCallbackGroup
        from rclpy.guard_condition import GuardCondition

        class OfNoExecutor(ReentrantCallbackGroup):
            """A callback group whose entities no executor calls."""

            def can_execute(self, entity):
                return False

        self.group = OfNoExecutor()
        self._context, self._outbox, self._report = context, outbox, report
        self._taken = ()
        self._changed = GuardCondition(None, None, context=context)
        self._is_leaving = False
        self._thread = threading.Thread(target=self._run, name="topics", daemon=True)

    def add(self, subscription, stream, wakes):
        """Pass on the messages of a topic: at once where they wake somebody, otherwise with others."""
        self._taken = (*self._taken, (subscription, stream, wakes))
        self._changed.trigger()
        if not self._thread.is_alive() and not self._is_leaving:
            self._thread.start()

    def _run(self):
        while not self._is_leaving:
            try:
                self._take(self._taken)
            except Exception as error:  # noqa: BLE001 - of rclpy, while nodes come and go; the others go on
                if not self._is_leaving:
                    self._report(f"rclpy: {type(error).__name__}: {error}")
                    time.sleep(0.01)

    def _take(self, taken):
        """Take what arrives on these topics, until there are others."""
        from rclpy.impl.implementation_singleton import rclpy_implementation

        waking = {one.handle.pointer: one.handle for one, _, wakes in taken if wakes}
        looks_ns = QUIET_NS if 0 < len(waking) < len(taken) else LOOKS_NS
        waking = waking or {one.handle.pointer: one.handle for one, _, _ in taken}
        waiting = rclpy_implementation.WaitSet(len(waking), 1, 0, 0, 0, 0, self._context.handle)
        while taken is self._taken and not self._is_leaving:
            waiting.clear_entities()
            for handle in waking.values():
                waiting.add_subscription(handle)
            waiting.add_guard_condition(self._changed.handle)
            waiting.wait(looks_ns)
            idle = waking.keys()
            if waiting.get_ready_entities("subscription"):
                idle = ()
                time.sleep(GATHERS_S)
            found = []
            try:
                for subscription, stream, _ in taken:
                    handle = subscription.handle
                    if handle.pointer not in idle:
                        found += _take_from(handle, subscription.msg_type, stream)
            finally:  # what was taken is passed on, whatever the next topic raises
                if found:
                    self._outbox.put_messages(found)

    def leave(self):
        """Take nothing more."""
        self._is_leaving = True
        self._changed.trigger()
        if self._thread.is_alive():
            self._thread.join(0.3)


def _take_from(handle, kind, stream):
    """Yield the messages that wait in a subscription, with their stream."""
    for _ in range(MOST_AT_ONCE):
        taken = handle.take_message(kind, True)
        if taken is None:
            return
        data, info = taken
        source = _source(info)
        yield stream, bytes([len(source)]) + source + data


class Node:
    """A node, its participant and the threads that take what arrives for it.

    Args:
        name: Name of the node.
        namespace: Namespace of the node.
        threads: How many callbacks may run at a time.
        outbox: Where the messages of topics go.
    """

    def __init__(self, name, namespace, threads, outbox):
        import rclpy
        from rclpy.context import Context
        from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
        from rclpy.signals import SignalHandlerOptions

        self.context = Context()
        rclpy.init(args=[], context=self.context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node(
            name,
            namespace=namespace,
            context=self.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        if threads > 1:
            self._executor = MultiThreadedExecutor(threads, context=self.context)
        else:
            self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._mark = self._make_mark() if "zenoh" not in rclpy.get_rmw_implementation_identifier() else None
        self._participant = ""
        self.topics = Topics(self.context, outbox, lambda text: self._report(text))
        self._is_leaving = False
        self._thread = threading.Thread(target=self._spin, name="spin", daemon=True)

    @property
    def participant(self):
        """The part of GUIDs that all endpoints of this node have, in hex; "" where it is not known."""
        until = time.monotonic() + MARKS_S
        while self._mark is not None and not self._participant and time.monotonic() < until:
            time.sleep(0.01)
            for info in self.node.get_publishers_info_by_topic(self._mark.topic_name):
                self._participant = bytes(info.endpoint_gid).hex()[:PARTICIPANT]
        return self._participant

    def _make_mark(self):
        """Offer a topic that nobody else has: other nodes may have the same name."""
        return self.node.create_publisher(
            load_kind("rcl_interfaces/msg/Log"), f"_{self.node.get_name()}_{uuid.uuid4().hex}", 1
        )

    def start(self, report):
        """Take what arrives; `report` is called with what goes wrong."""
        self._report = report
        self._thread.start()

    def _spin(self):
        while not self._is_leaving:
            try:
                self._executor.spin_once()
            except Exception as error:  # noqa: BLE001 - of rclpy, while nodes come and go; the others go on
                if not self._is_leaving:
                    self._report(f"rclpy: {type(error).__name__}: {error}")
                    time.sleep(0.01)

    def leave(self):
        """Take the node off the network."""
        self._is_leaving = True
        self.topics.leave()
        with contextlib.suppress(Exception):
            self._executor.create_task(lambda: None)  # so that the thread sees it
            self._thread.join(0.3)
            self.node.destroy_node()
            self.context.try_shutdown()


class Relay:
    """Does what trundle asks for, and passes on what arrives."""

    def __init__(self, sock, name, namespace):
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup

        self._sock = sock
        self.outbox = Outbox(sock)
        self._name, self._namespace = name, namespace
        self._service_group = MutuallyExclusiveCallbackGroup()  # trundle answers one after the other
        self._home = Node(name, namespace, MAX_GOALS + 8, self.outbox)
        self._more_homes = []
        self._types_of_topics = {}  # topic → [(type, Node)]
        self._publishers, self._subscriptions = {}, {}
        self._services, self._actions, self._streams = [], {}, {}
        self._numbers = itertools.count(1)
        self._questions, self._goals, self._goals_of_ids = {}, {}, {}
        self._noted = set()
        self._slow_calls = queue.SimpleQueue()

    def run(self):
        """Work until trundle closes the socket."""
        self._home.start(self._note)
        for work in (self._work_off, self._report_counts):
            threading.Thread(target=work, name=work.__name__, daemon=True).start()
        try:
            for kind, number, payload in read_frames(self._sock):
                if kind == PUBLISH:
                    self._publish(number, payload)
                elif kind == CALL:
                    self._call(number, payload)
                elif kind == ANSWER:
                    question = self._questions.get(number)
                    if question is not None:
                        question.put(payload)
                elif kind == FEEDBACK:
                    self._feed_back(number, payload)
                elif kind == RESULT:
                    self._end(number, payload)
        except Exception as error:  # noqa: BLE001 - whatever happened, the node leaves the network in order
            sys.stderr.write(f"trundle's relay stops: {error}\n")

    def leave(self):
        """Abort what is unfinished, so that its clients hear of it, and take the node off the network."""
        for question in list(self._questions.values()):
            question.put(b"")
        goals = list(self._goals.values())
        for goal in goals:
            goal.end.put((ABORTED, b""))
        until = time.monotonic() + 0.3
        while self._goals and time.monotonic() < until:
            time.sleep(0.01)
        if goals:
            time.sleep(0.1)  # rclpy's threads are sending the results
        for server in self._actions.values():  # they would keep the node alive
            with contextlib.suppress(Exception):
                server.destroy()
        for home in [self._home, *self._more_homes]:
            home.leave()

    def _note(self, text):
        if text not in self._noted and len(self._noted) < 100:
            self._noted.add(text)
            self.outbox.put(NOTE, 0, text.encode())

    # Calls

    def _call(self, number, payload):
        call = json.loads(payload)
        do = call.pop("do")
        if do in ("graph", "endpoints", "definition"):
            self._slow_calls.put((number, getattr(self, "_do_" + do), call))
        else:
            self._reply(number, getattr(self, "_do_" + do), call)

    def _work_off(self):
        while True:
            self._reply(*self._slow_calls.get())

    def _reply(self, number, do, call):
        try:
            answer = {"value": do(**call)}
        except RefusedError as error:
            answer = {"error": str(error)}
        except Exception as error:  # noqa: BLE001 - of rclpy, about names, types and QoS; trundle reports it
            answer = {"error": f"{type(error).__name__}: {error}"}
        self.outbox.put(REPLY, number, json.dumps(answer).encode())

    def _home_of(self, topic, type_name):
        """Return the node for a topic of this type: in a participant of Fast DDS, a topic has one type."""
        import rclpy

        if "fastrtps" not in rclpy.get_rmw_implementation_identifier():
            return self._home
        homes = self._types_of_topics.setdefault(topic, [])
        for known, home in homes:
            if known == type_name:
                return home
        taken = [home for _, home in homes]
        home = next((home for home in [self._home, *self._more_homes] if home not in taken), None)
        if home is None:
            home = Node(f"{self._name}_{len(self._more_homes) + 2}", self._namespace, 1, self.outbox)
            home.start(self._note)
            self._more_homes.append(home)
        homes.append((type_name, home))
        return home

    def _do_publisher(self, number, topic, type, qos):
        kind = load_kind(type)
        home = self._home_of(topic, type)
        self._publishers[number] = home.node.create_publisher(
            kind, topic, _profile(qos), event_callbacks=_no_events("PublisherEventCallbacks")
        )

    def _do_subscription(self, number, topic, type, qos, wakes):
        kind = load_kind(type)
        stream = Stream(SAMPLE, number, qos["depth"])
        home = self._home_of(topic, type)
        subscription = home.node.create_subscription(
            kind,
            topic,
            lambda data: None,
            _profile(qos),
            callback_group=home.topics.group,
            raw=True,
            event_callbacks=_no_events("SubscriptionEventCallbacks"),
        )
        home.topics.add(subscription, stream, wakes)
        self._subscriptions[number], self._streams[number] = subscription, stream

    def _do_service(self, number, name, type):
        from rclpy.serialization import deserialize_message, serialize_message

        kind = load_kind(type)

        def callback(request, response):
            answer = self._ask(REQUEST, number, serialize_message(request))
            if answer[:1] != b"\1":
                return response  # as ROS makes it: no success
            return deserialize_message(answer[1:], kind.Response)

        service = self._home.node.create_service(kind, name, callback, callback_group=self._service_group)
        self._services.append(service)

    def _do_action(self, number, name, type):
        from rclpy.action import ActionServer, CancelResponse, GoalResponse
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
        from rclpy.serialization import serialize_message

        kind = load_kind(type)

        def accept(request):
            if len(self._goals) >= MAX_GOALS:
                self._note(f"{name}: a goal was rejected, because {MAX_GOALS} are unfinished")
                return GoalResponse.REJECT
            is_wanted = self._ask(GOAL, number, serialize_message(request)) == b"\1"
            return GoalResponse.ACCEPT if is_wanted else GoalResponse.REJECT

        def start(handle):
            goal = Goal(next(self._numbers), handle, kind)
            uuid = bytes(handle.goal_id.uuid)
            self._goals[goal.number] = self._goals_of_ids[uuid] = goal
            handle.execute()
            self.outbox.put(STARTED, goal.number, NUMBER.pack(number) + uuid + serialize_message(handle.request))

        def cancel(handle):
            goal = self._goals_of_ids.get(bytes(handle.goal_id.uuid))
            is_wanted = goal is not None and self._ask(CANCEL, goal.number) == b"\1"
            return CancelResponse.ACCEPT if is_wanted else CancelResponse.REJECT

        self._actions[number] = ActionServer(
            self._home.node,
            kind,
            name,
            self._execute,
            callback_group=MutuallyExclusiveCallbackGroup(),
            goal_callback=accept,
            handle_accepted_callback=start,
            cancel_callback=cancel,
        )

    def _do_definition(self, type):
        return define(type)

    def _do_graph(self):
        from rclpy import action

        node = self._home.node
        endpoints = [end for topic, _ in node.get_topic_names_and_types() for end in _endpoints(node, topic)]
        questions = {
            "service server": node.get_service_names_and_types_by_node,
            "service client": node.get_client_names_and_types_by_node,
            "action server": lambda *of: action.get_action_server_names_and_types_by_node(node, *of),
            "action client": lambda *of: action.get_action_client_names_and_types_by_node(node, *of),
        }
        nodes = node.get_node_names_and_namespaces()
        offers = []
        for kind, ask in questions.items():
            for name, namespace in nodes:
                with contextlib.suppress(Exception):  # it has left since
                    offers += [
                        {"kind": kind, "name": offer, "type": types[0], "node": name, "namespace": namespace}
                        for offer, types in ask(name, namespace)
                    ]
        return {"nodes": nodes, "endpoints": endpoints, "offers": offers, **self._ours()}

    def _do_endpoints(self, topic):
        return {"endpoints": _endpoints(self._home.node, topic), **self._ours()}

    def _ours(self):
        """Return our nodes, and their participants where all are known."""
        homes = [self._home, *self._more_homes]
        participants = [home.participant for home in homes]
        return {
            "ours": [(home.node.get_name(), home.node.get_namespace()) for home in homes],
            "participants": participants if all(participants) else [],
        }

    # Messages

    def _publish(self, number, payload):
        publisher = self._publishers.get(number)
        if publisher is None:
            return
        try:
            publisher.publish(payload)
        except Exception as error:  # noqa: BLE001 - of the middleware
            self._note(f"{publisher.topic}: a message could not be published: {error}")

    def _report_counts(self):
        """Report what is matched and dropped, when it changes."""
        last = None
        while True:
            time.sleep(COUNTS_EVERY_S)
            try:
                counts = {
                    "publishers": {n: self._count_readers(p) for n, p in list(self._publishers.items())},
                    "subscriptions": {n: _count_publishers(s) for n, s in list(self._subscriptions.items())},
                    "dropped": {n: s.dropped for n, s in list(self._streams.items())},
                }
            except Exception:  # noqa: BLE001 - while the node is being destroyed
                continue
            if counts != last:
                last = counts
                self.outbox.put(COUNTS, 0, json.dumps(counts).encode())

    def _count_readers(self, publisher):
        """Count the subscriptions of others that match a publisher: rclpy has no way to leave out our own."""
        count = publisher.get_subscription_count()
        if count:
            count -= sum(
                one.topic == publisher.topic and one.msg_type is publisher.msg_type and _fit(publisher, one)
                for one in list(self._subscriptions.values())
            )
        return max(count, 0)

    # Services and actions

    def _ask(self, kind, number, payload=b""):
        """Ask trundle, and wait for its answer; empty when it is gone."""
        answer = queue.SimpleQueue()
        token = next(self._numbers)
        self._questions[token] = answer
        try:
            self.outbox.put(kind, token, NUMBER.pack(number) + payload)
            return answer.get()
        finally:
            del self._questions[token]

    def _execute(self, handle):
        """Wait for the end of a goal."""
        from rclpy.serialization import deserialize_message

        goal = self._goals_of_ids[bytes(handle.goal_id.uuid)]
        how, data = goal.end.get()
        result = goal.kind.Result()
        try:
            if data:
                result = deserialize_message(data, goal.kind.Result)
            end_goal(handle, how)
        except Exception as error:  # noqa: BLE001 - of rclpy, such as canceled without a request to cancel
            self._note(f"a goal could not end as asked and is aborted: {error}")
            handle.abort()
        finally:
            del self._goals[goal.number]
            del self._goals_of_ids[bytes(handle.goal_id.uuid)]
        return result

    def _feed_back(self, number, payload):
        from rclpy.serialization import deserialize_message

        goal = self._goals.get(number)
        if goal is not None:
            try:
                goal.handle.publish_feedback(deserialize_message(payload, goal.kind.Feedback))
            except Exception as error:  # noqa: BLE001 - of the middleware
                self._note(f"feedback could not be published: {error}")

    def _end(self, number, payload):
        goal = self._goals.get(number)
        if goal is not None:
            goal.end.put((payload[0], payload[1:]))


def end_goal(handle, how):
    """Let a goal end as trundle says.

    Trundle may be done with canceling it before rclpy, whose callback asked trundle, has the goal as being canceled:
    until then it cannot end so.
    """
    until = time.monotonic() + CANCELING_S
    while how == CANCELED and not handle.is_cancel_requested and time.monotonic() < until:
        time.sleep(0.001)
    (handle.succeed, handle.abort, handle.canceled)[how]()


def _profile(qos):
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(
        depth=qos["depth"],
        reliability=ReliabilityPolicy[qos["reliability"].upper()],
        durability=DurabilityPolicy[qos["durability"].upper()],
    )


def _no_events(kind):
    """Ask for no callbacks for events: rclpy's own only log, and each costs time whenever anything arrives."""
    try:
        module = importlib.import_module("rclpy.event_handler")
    except ImportError:  # Humble
        module = importlib.import_module("rclpy.qos_event")
    return getattr(module, kind)(use_default_callbacks=False)


def _source(info):
    """Return the publisher's id in a message's info; Humble and Jazzy have none there."""
    gid = info.get("publisher_gid") if isinstance(info, dict) else None
    data = gid.get("data") if isinstance(gid, dict) else None
    return bytes(data).hex().encode() if data else b""


def _count_publishers(subscription):
    """Count the publishers of a subscription; Humble's cannot: -1."""
    count = getattr(subscription, "get_publisher_count", None)
    return -1 if count is None else count()


def _fit(publisher, subscription):
    """Return whether a subscription asks for no more than a publisher offers."""
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    offered, asked = publisher.qos_profile, subscription.qos_profile
    is_less = asked.reliability == ReliabilityPolicy.RELIABLE != offered.reliability
    return not is_less and not asked.durability == DurabilityPolicy.TRANSIENT_LOCAL != offered.durability


def _endpoints(node, topic):
    """Return the publishers and subscriptions of a topic."""
    publishers, subscriptions = node.get_publishers_info_by_topic(topic), node.get_subscriptions_info_by_topic(topic)
    found = [_endpoint("publisher", topic, info) for info in publishers]
    return found + [_endpoint("subscription", topic, info) for info in subscriptions]


def _endpoint(kind, topic, info):
    qos = info.qos_profile
    return {
        "kind": kind,
        "topic": topic,
        "node": info.node_name,
        "namespace": info.node_namespace,
        "type": info.topic_type,
        "hash": str(getattr(info, "topic_type_hash", None) or ""),
        "gid": bytes(info.endpoint_gid).hex(),
        "reliability": qos.reliability.name.lower(),
        "durability": qos.durability.name.lower(),
        "depth": qos.depth,
    }


# The program ---------------------------------------------------------------------------------------------------------

_DISTRO_OF_RCLPY = {3: "humble", 4: "iron", 7: "jazzy", 9: "kilted"}


def _distro():
    """Return the distribution: as sourced, or guessed from rclpy's version."""
    if os.environ.get("ROS_DISTRO"):
        return os.environ["ROS_DISTRO"]
    with contextlib.suppress(Exception):
        major = int(importlib.metadata.version("rclpy").partition(".")[0])
        return _DISTRO_OF_RCLPY.get(major, "lyrical" if major > 9 else "")
    return ""


def _set_range(where, distro):
    """Set how far discovery reaches; Humble has another variable for it."""
    for name in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
        os.environ.pop(name, None)
    if distro == "humble":
        os.environ["ROS_LOCALHOST_ONLY"] = "1" if where == "localhost" else "0"
    else:
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = where.upper()


def _die_with(parent):
    """Have this process sent SIGTERM when trundle dies, however it dies."""
    with contextlib.suppress(Exception):  # Linux alone has it; elsewhere the closed socket has to do
        ctypes.CDLL(None).prctl(1, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(0)


def _hang_up_on_sigterm(sock):
    """Have the relay leave on SIGTERM as if trundle had closed the socket."""
    signal.sigwait([signal.SIGTERM])
    with contextlib.suppress(OSError):
        sock.shutdown(socket.SHUT_RDWR)


def _exit_later():
    time.sleep(LEAVING_S)
    os._exit(1)


def main():
    """Relay until trundle closes the socket, SIGTERM comes or trundle dies."""
    if sys.version_info < (3, 10):  # noqa: UP036 - whichever is called python3 in the user's shell
        raise SystemExit("this Python is too old: ROS 2 has 3.10 or later")
    fd, parent, options = int(sys.argv[1]), int(sys.argv[2]), json.loads(sys.argv[3])
    sock = socket.socket(fileno=fd)
    # Not a handler: Python would run it in this thread alone, which may be about to wait for the socket.
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
    threading.Thread(target=_hang_up_on_sigterm, args=(sock,), daemon=True).start()
    _die_with(parent)
    here = pathlib.Path(__file__).resolve().parent
    sys.path[:] = [entry for entry in sys.path if pathlib.Path(entry).resolve() != here]
    distro = _distro()
    if options["range"]:
        _set_range(options["range"], distro)
    try:
        import rclpy

        relay = Relay(sock, options["node"], options["namespace"])
        hello = {"distro": distro, "rmw": rclpy.get_rmw_implementation_identifier()}
    except Exception as error:  # noqa: BLE001 - whatever is wrong with this ROS: trundle reports it
        text = f"{type(error).__name__}: {error}".encode()
        sock.sendall(HEADER.pack(len(text), REFUSED, 0) + text)
        os._exit(0)
    relay.outbox.put(HELLO, 0, json.dumps(hello).encode())
    relay.run()
    threading.Thread(target=_exit_later, daemon=True).start()
    relay.leave()
    os._exit(0)  # at once: threads of rclpy may be waiting


if __name__ == "__main__":
    main()
