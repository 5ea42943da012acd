"""Small policies in ONNX files, made without a learning framework."""

from pathlib import Path

import numpy as np

GOAL_SEEKER = {
    "observations": "ranges,goal,velocity",
    "beams": "36",
    "reach": "12.0",
    "period": "0.2",
    "scale": "0.5,0.7",
}
"""The metadata of `write_policy`'s network."""


def write_policy(
    path: Path, metadata: dict[str, str] | None = None, *, beams: int = 36, weight: float = 1.0, memory: bool = False
) -> Path:
    """Write a policy that turns to the goal and drives there; v = cos, w = sin of its direction.

    With memory, its state counts the actions since the reset, and v falls by a tenth of that.
    """
    from onnx import TensorProto, helper, numpy_helper

    def constant(name: str, values: object):
        return numpy_helper.from_array(np.asarray(values, dtype=np.float32), name)

    turn = np.zeros((beams + 5, 2), dtype=np.float32)
    turn[beams + 1, 0] = turn[beams + 2, 1] = weight
    inputs = {"ranges": [1, beams], "goal": [1, 3], "velocity": ["batch", 2]}
    outputs = {"action": [1, 2]}
    nodes = [
        helper.make_node("Concat", list(inputs), ["all"], axis=1),
        helper.make_node("MatMul", ["all", "turn"], ["heading" if memory else "action"]),
    ]
    constants = [constant("turn", turn)]
    if memory:
        inputs["memory"], outputs["memory_next"] = [1, 1], [1, 1]
        constants += [constant("one", [[1.0]]), constant("slower", [[-0.1, 0.0]])]
        nodes += [
            helper.make_node("MatMul", ["memory", "slower"], ["less"]),
            helper.make_node("Add", ["heading", "less"], ["action"]),
            helper.make_node("Add", ["memory", "one"], ["memory_next"]),
        ]
        metadata = {**(metadata or GOAL_SEEKER), "states": "memory=memory_next"}
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in inputs.items()],
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in outputs.items()],
        constants,
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    texts = GOAL_SEEKER if metadata is None else metadata
    helper.set_model_props(model, {f"trundle.{key}": text for key, text in texts.items()})
    path.write_bytes(model.SerializeToString())
    return path


def write_path_follower(path: Path, *, points: int = 2) -> Path:
    """Write a policy that drives to the first point of the path; v = x and w = y of it [m]."""
    from onnx import TensorProto, helper, numpy_helper

    pick = np.zeros((2 * points, 2), dtype=np.float32)
    pick[0, 0] = pick[1, 1] = 1.0
    graph = helper.make_graph(
        [
            helper.make_node("Flatten", ["path"], ["flat"]),
            helper.make_node("MatMul", ["flat", "pick"], ["action"]),
        ],
        "policy",
        [helper.make_tensor_value_info("path", TensorProto.FLOAT, ["batch", points, 2])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["batch", 2])],
        [numpy_helper.from_array(pick, "pick")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    texts = {"observations": "path", "path_points": str(points), "period": "0.2", "scale": "0.5,0.7"}
    helper.set_model_props(model, {f"trundle.{key}": text for key, text in texts.items()})
    path.write_bytes(model.SerializeToString())
    return path
