"""`PolicyFile`: a policy's ONNX file, checked: its metadata, its inputs and outputs, and what it computes."""

from __future__ import annotations

import importlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.extras import missing_extra
from trundle.files.opening import read_limited

Floats = npt.NDArray[np.float32]
_Read = TypeVar("_Read")

OBSERVATIONS = ("ranges", "goal", "velocity", "path")
"""What a policy may observe; `ranges` has as many as its beams, `path` its points, and the others these sizes:"""
_SIZES = {"goal": 3, "velocity": 2}

SHORTEST_PERIOD_S = 0.005
"""The physics step of the simulators [s], of which control periods are multiples."""

_PREFIX = "trundle."
_LARGEST_FILE = 512 << 20
_MOST_BEAMS = 100_000
_HELP = "see docs/learning.md, or let trundle.gym.policy_metadata make the metadata"


@dataclass(frozen=True, slots=True, eq=False)
class PolicyFile:
    """A policy's ONNX file. Its metadata (`metadata_props`) are texts by these keys, each with `trundle.` before it.

    | key | example | what it is |
    | --- | --- | --- |
    | `observations` | `ranges,goal,velocity` | the inputs that are observations, float32, shape (1, size) |
    | `beams` | `180` | beams of each lidar |
    | `reach` | `12.0` | ranges are cut off here, and are this without a return [m] |
    | `path_points` | `8` | points of `path`, of the shape (1, points, 2), 0.5 m apart |
    | `lidars` | `front` | which lidars, in this order; without it the robot's first |
    | `period` | `0.2` | time from one action to the next [s], at least 0.005 |
    | `scale` | `0.8,0.7` | v [m/s] and w [rad/s] of an action of 1; actions are cut off at −1 and 1 |
    | `offset` | `0.0,0.0` | v and w of an action of 0; without it zeros |
    | `normalisation` | `{"ranges": [0.0, 12.0]}` | (mean, scale) of observations, numbers or lists: the network gets
      (value − mean) / scale; without it the values themselves |
    | `states` | `memory=memory_next` | recurrent inputs and the outputs that they become; zeros after a reset |

    The first output that is no state is the action, shape (1, 2).

    Attributes:
        path: The file.
        observations: What it observes, of `OBSERVATIONS`.
        beams: Beams of each lidar; 0 where it observes none.
        reach: Longest range [m].
        path_points: Points of the path that it observes; 0 where it observes none.
        lidars: Names of the lidars; empty for the robot's first.
        period: Time from one action to the next [s].
        scale: v [m/s] and w [rad/s] of an action of 1, shape (2,).
        offset: v and w of an action of 0, shape (2,).
        normalisation: Mean and scale of observations.
        states: The outputs that the recurrent inputs become, by their names.
    """

    path: Path
    observations: tuple[str, ...]
    beams: int
    reach: float
    path_points: int
    lidars: tuple[str, ...]
    period: float
    scale: npt.NDArray[np.float64]
    offset: npt.NDArray[np.float64]
    normalisation: Mapping[str, tuple[Floats, Floats]]
    states: Mapping[str, str]
    _session: Any
    _action: str
    _shapes: Mapping[str, tuple[int, ...]]

    @classmethod
    def load(cls, path: str | Path) -> PolicyFile:
        """Read a policy, and compute one action with it.

        Raises:
            InputError: If the file cannot be read, is no ONNX model, or lacks or has wrong metadata or shapes.
            MissingExtraError: If onnxruntime is not installed.
        """
        place = Path(path)
        session = _open_session(place)
        texts = {
            key.removeprefix(_PREFIX): text
            for key, text in session.get_modelmeta().custom_metadata_map.items()
            if key.startswith(_PREFIX)
        }
        read = _Metadata(place, texts)
        observations = read.get("observations", _names)
        for name in observations:
            if name not in OBSERVATIONS:
                raise InputError(
                    f"{place}: trundle.observations: a robot cannot observe {name!r}; a policy may observe: "
                    f"{', '.join(OBSERVATIONS)}"
                )
        sees = "ranges" in observations
        made = cls(
            path=place,
            observations=observations,
            beams=read.get("beams", _count) if sees else 0,
            reach=read.get("reach", _positive) if sees else 0.0,
            path_points=read.get("path_points", _count) if "path" in observations else 0,
            lidars=read.get("lidars", _names, ()),
            period=read.get("period", _period),
            scale=read.get("scale", _pair),
            offset=read.get("offset", _pair, np.zeros(2)),
            normalisation=read.get("normalisation", _normalisation, {}),
            states=read.get("states", _pairs, {}),
            _session=session,
            _action=_action_of(place, session, read.get("states", _pairs, {})),
            _shapes={each.name: _fixed(each.shape) for each in session.get_inputs()},
        )
        made._check_inputs()
        if not sees or made.lidars:
            made.check_beams(max(1, len(made.lidars)))
        return made

    def zero_states(self) -> dict[str, Floats]:
        """Return the recurrent state at the beginning."""
        return {name: np.zeros(self._shapes[name], dtype=np.float32) for name in self.states}

    def act(self, values: Mapping[str, Floats], states: Mapping[str, Floats]) -> tuple[Floats, dict[str, Floats]]:
        """Compute an action, shape (2,), and the next recurrent state.

        Args:
            values: Observations by name, not normalised; more than it observes are allowed.
            states: The recurrent state.
        """
        given = {name: self._normalise(name, values[name])[None] for name in self.observations}
        names = [self._action, *self.states.values()]
        found = cast("list[Floats]", self._session.run(names, {**given, **states}))
        return found[0].reshape(-1), dict(zip(self.states, found[1:], strict=True))

    def command_of(self, action: Floats) -> tuple[float, float]:
        """Return the v [m/s] and w [rad/s] of an action."""
        v, w = np.clip(action.astype(np.float64), -1.0, 1.0) * self.scale + self.offset
        return float(v), float(w)

    def check_beams(self, lidars: int) -> None:
        """Check that it computes an action of the scans of so many lidars.

        Raises:
            InputError: If it has other shapes.
        """
        wanted = {name: (size,) for name, size in _SIZES.items()}
        wanted |= {"ranges": (self.beams * lidars,), "path": (self.path_points, 2)}
        sizes = {name: math.prod(shape) for name, shape in wanted.items()}
        for name in self.observations:
            shape, due = self._shapes[name], (1, *wanted[name])
            if shape != due:
                key = "path_points" if name == "path" else "beams"
                has = self.path_points if name == "path" else self.beams
                raise InputError(
                    f"{self.path}: the input {name!r} has the shape {shape}, and the observation {due}: "
                    f"correct the metadata (trundle.{key} is {has}), or export the policy again"
                )
        try:
            _check_normalisation(self.normalisation, {name: sizes[name] for name in self.observations})
        except ValueError as error:
            raise InputError(f"{self.path}: trundle.normalisation {error}") from None
        blank = {name: np.ones(wanted[name], dtype=np.float32) for name in self.observations}
        try:
            action, states = self.act(blank, self.zero_states())
        except Exception as error:
            raise InputError(f"{self.path}: the policy cannot be computed: {_first_line(error)}") from error
        if action.shape != (2,):
            raise InputError(
                f"{self.path}: the output {self._action!r} has {action.size} numbers: an action is (v, w), shape (1, 2)"
            )
        for name, after in states.items():
            if after.shape != self._shapes[name]:
                raise InputError(
                    f"{self.path}: the state {name!r} has the shape {self._shapes[name]}, and becomes "
                    f"{self.states[name]!r} of {after.shape}: they must be alike"
                )

    def _normalise(self, name: str, values: Floats) -> Floats:
        if name not in self.normalisation:
            return values
        mean, scale = self.normalisation[name]
        return ((values.reshape(-1) - mean) / scale).reshape(values.shape)

    def _check_inputs(self) -> None:
        inputs = {each.name: each for each in self._session.get_inputs()}
        for name in (*self.observations, *self.states):
            if name not in inputs:
                raise InputError(
                    f"{self.path}: the metadata name the input {name!r}, and the network has: {', '.join(inputs)}; "
                    f"{_HELP}"
                )
        for name, each in inputs.items():
            if name not in (*self.observations, *self.states):
                raise InputError(
                    f"{self.path}: the input {name!r} is in neither trundle.observations nor trundle.states; {_HELP}"
                )
            if each.type != "tensor(float)":
                raise InputError(f"{self.path}: the input {name!r} is {each.type}: policies take float32")


@dataclass(frozen=True, slots=True)
class _Metadata:
    path: Path
    texts: Mapping[str, str]

    def get(self, key: str, read: Callable[[str], _Read], default: _Read | None = None) -> _Read:
        """Read the text of a key; one without a default has to be there."""
        text = self.texts.get(key)
        if text is None:
            if default is not None:
                return default
            has = ", ".join(_PREFIX + name for name in self.texts) or "none of trundle's"
            raise InputError(f"{self.path}: its metadata lack {_PREFIX}{key}; they have {has}; {_HELP}")
        try:
            return read(text)
        except (ValueError, TypeError, AttributeError) as error:
            raise InputError(f"{self.path}: {_PREFIX}{key} is {text!r:.80}: {error}; {_HELP}") from None


def _open_session(path: Path) -> Any:
    try:
        runtime: Any = importlib.import_module("onnxruntime")
    except ImportError:
        raise missing_extra(f"the policy {path}", "onnxruntime", "policy") from None
    too_large = f"it has more than {_LARGEST_FILE >> 20} MB: this is no policy for a robot"
    content = read_limited(path, _LARGEST_FILE, too_large, error=InputError, wanted="a policy's ONNX file")
    options = runtime.SessionOptions()
    # One thread computes the same on every machine, and is faster for networks of this size.
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        # Of bytes: a model that refers to other files is refused.
        return runtime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:
        raise InputError(
            f"{path}: this is no ONNX model that can be computed: {_first_line(error)}; export the policy again"
        ) from error


def _first_line(error: Exception) -> str:
    return f"{type(error).__name__}: {error}".splitlines()[0][:300]


def _action_of(path: Path, session: Any, states: Mapping[str, str]) -> str:
    outputs = [each.name for each in session.get_outputs()]
    for name in states.values():
        if name not in outputs:
            raise InputError(
                f"{path}: trundle.states names the output {name!r}, and the network has: {', '.join(outputs)}"
            )
    actions = [name for name in outputs if name not in states.values()]
    if not actions:
        raise InputError(f"{path}: all outputs are states: a policy needs one for the action, shape (1, 2)")
    return actions[0]


def _fixed(shape: Sequence[int | str | None]) -> tuple[int, ...]:
    """Return a shape with 1 for what the file leaves open, such as the size of a batch."""
    return tuple(size if isinstance(size, int) else 1 for size in shape)


def _names(text: str) -> tuple[str, ...]:
    found = tuple(name.strip() for name in text.split(","))
    if not all(found) or len(set(found)) < len(found):
        raise ValueError("it must be different names, separated by commas")
    return found


def _count(text: str) -> int:
    if not (text.isdecimal() and 1 <= int(text) <= _MOST_BEAMS):
        raise ValueError(f"it must be a whole number from 1 to {_MOST_BEAMS}")
    return int(text)


def _positive(text: str) -> float:
    value = float(text)
    if not 1e-3 <= value <= 1e4:
        raise ValueError("it must be from 0.001 to 10,000")
    return value


def _period(text: str) -> float:
    value = float(text)
    if not SHORTEST_PERIOD_S <= value <= 1e4:
        raise ValueError(f"it must be from {SHORTEST_PERIOD_S:g}, the physics step of the simulators, to 10,000 s")
    return value


def _pair(text: str) -> npt.NDArray[np.float64]:
    values = np.array([float(part) for part in text.split(",")])
    if values.shape != (2,) or not (np.abs(values) < 1e3).all():
        raise ValueError("it must be two numbers, separated by a comma: v [m/s] and w [rad/s]")
    return values


def _pairs(text: str) -> dict[str, str]:
    found = dict(part.strip().split("=") for part in text.split(",") if part.strip())
    if not all(found.values()):
        raise ValueError("it must be input=output, several of them separated by commas")
    return found


def _normalisation(text: str) -> dict[str, tuple[Floats, Floats]]:
    return _read_normalisation(json.loads(text))


def _read_normalisation(given: Mapping[str, tuple[object, object]]) -> dict[str, tuple[Floats, Floats]]:
    found: dict[str, tuple[Floats, Floats]] = {}
    for name, (mean, scale) in given.items():
        values = tuple(np.atleast_1d(np.array(part, dtype=np.float32)) for part in (mean, scale))
        if any(each.ndim != 1 or not np.isfinite(each).all() for each in values) or not (values[1] >= 1e-6).all():
            raise ValueError(f"mean and scale of {name} must be finite, and scale above 0, at least 1e-6")
        found[str(name)] = values[0], values[1]
    return found


def _check_normalisation(given: Mapping[str, tuple[Floats, Floats]], sizes: Mapping[str, int]) -> None:
    """Check that a normalisation is of observations, and has one number or as many as each has values."""
    for name, parts in given.items():
        for values in parts:
            if name not in sizes or values.size not in (1, sizes[name]):
                raise ValueError(
                    f"has {values.size} numbers for {name!r}; observations are {', '.join(sizes)}, and each needs one "
                    "number or as many as it has values"
                )


def metadata_for(
    *,
    observations: Sequence[str],
    beams: int,
    reach: float,
    lidars: Sequence[str],
    path_points: int = 0,
    period: float,
    scale: Sequence[float],
    offset: Sequence[float],
    normalisation: Mapping[str, tuple[object, object]],
    states: Mapping[str, str],
) -> dict[str, str]:
    """Return the metadata of a policy as texts by key, for `metadata_props`; see `PolicyFile`.

    Raises:
        InputError: If `PolicyFile` would refuse the observations, states or normalisation.
    """
    sizes = {**_SIZES, "ranges": beams * len(lidars), "path": 2 * path_points}
    texts = {
        "observations": ",".join(observations),
        "beams": str(beams),
        "reach": repr(float(reach)),
        "lidars": ",".join(lidars),
        "path_points": str(path_points) if path_points else "",
        "period": repr(float(period)),
        "scale": ",".join(repr(float(each)) for each in scale),
        "offset": ",".join(repr(float(each)) for each in offset),
        "normalisation": _normalisation_text(normalisation, {name: sizes[name] for name in observations}),
        "states": ",".join(f"{name}={after}" for name, after in states.items()),
    }
    for key, read in {"observations": _names, "states": _pairs}.items():
        try:
            read(texts[key])
        except ValueError as error:
            raise InputError(f"{key} are {texts[key]!r:.80}: {error}") from None
    return {_PREFIX + key: text for key, text in texts.items() if text}


def _normalisation_text(given: Mapping[str, tuple[object, object]], sizes: Mapping[str, int]) -> str:
    try:
        read = _read_normalisation(given)
    except (ValueError, TypeError, AttributeError) as error:
        raise InputError(f"normalisation is {given!r:.80}: {error}") from None
    try:
        _check_normalisation(read, sizes)
    except ValueError as error:
        raise InputError(f"normalisation {error}") from None
    return json.dumps({name: [np.asarray(part, dtype=np.float64).tolist() for part in given[name]] for name in given})
