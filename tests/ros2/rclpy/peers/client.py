"""A ROS program: calls a service, or sends the goals that its input names, and reports what happens."""

# ruff: noqa: T201 - what it prints is for the test

import json
import sys

import rclpy
from rclpy.action import ActionClient
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

rclpy.init()
node = rclpy.create_node("client")
service = node.create_client(SetBool, "/set")
action = ActionClient(node, Fibonacci, "/count")
feedback = []
goals = []


def report(**facts):
    print(json.dumps(facts), flush=True)


def on_feedback(message):
    feedback.append(list(message.feedback.sequence))


def wait(future, timeout=60.0):
    rclpy.spin_until_future_complete(node, future, timeout_sec=timeout)
    return future.result()


def first_answer(timeout, ask, *arguments, **options):
    """What comes of asking again: a server that was killed is "ready" until its lease ends, and may get it alone."""
    tries = (wait(ask(*arguments, **options), timeout) for _ in range(10))
    return next(answer for answer in tries if answer is not None)


def send(order):
    goal = first_answer(5.0, action.send_goal_async, Fibonacci.Goal(order=order), feedback_callback=on_feedback)
    if goal.accepted:
        goals.append((goal, goal.get_result_async()))
    return goal.accepted


def end_of(number):
    end = wait(goals[number][1])
    return [end.status, list(end.result.sequence)]


for line in sys.stdin:
    do, *arguments = json.loads(line)
    if do == "ready":
        report(ready=[service.wait_for_service(20.0), action.wait_for_server(20.0)])
    elif do == "call":
        answer = first_answer(1.0, service.call_async, SetBool.Request(data=arguments[0]))
        report(call=[answer.success, answer.message])
    elif do == "send":
        report(accepted=send(*arguments))
    elif do == "end":
        report(end=end_of(*arguments))
    elif do == "feedback":
        for _ in range(400):
            if len(feedback) >= arguments[0]:
                break
            rclpy.spin_once(node, timeout_sec=0.05)
        report(feedback=feedback)
    elif do == "cancel":
        answer = wait(goals[arguments[0]][0].cancel_goal_async())
        report(canceling=len(answer.goals_canceling))
    elif do == "gone":
        for _ in range(400):
            if not action.server_is_ready():
                break
            rclpy.spin_once(node, timeout_sec=0.05)
        report(gone=not action.server_is_ready(), done=goals[-1][1].done())
