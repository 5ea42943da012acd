"""Train a policy that drives to goals: recurrent PPO on a vector environment, exported as policy.onnx.

It learns to drive without a map; with --path it learns to follow a planner's path around boxes that the map lacks.
Needs the extra gym, PyTorch and onnx; on a GPU the extra gpu too. --updates 2 --envs 16 --worlds 1 is a short try.
"""

import argparse
import time
from pathlib import Path

import gymnasium
import numpy as np
import torch
from torch import nn

from trundle.gym import policy_metadata  # importing trundle.gym registers the environments

parser = argparse.ArgumentParser()
parser.add_argument("--minutes", type=float, default=9.3, help="from the start to the end of training")
parser.add_argument("--updates", type=int, default=1_000_000)
parser.add_argument("--envs", type=int, default=8192)
parser.add_argument("--steps", type=int, default=32, help="of each update; gradients go back that far")
parser.add_argument("--parts", type=int, default=32, help="batches of an epoch, as large as each other")
parser.add_argument("--width", type=int, default=256, help="units of each layer")
parser.add_argument("--path", action="store_true", help="follow a path on a map that lacks some boxes")
parser.add_argument(
    "--worlds", type=int, default=400, help="offices; twice as many mazes, or with --path as many warehouses"
)
parser.add_argument("--judge", type=int, default=500, help="missions of each kind in unseen worlds")
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--out", default="policy.onnx")
parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
args = parser.parse_args()

start = time.perf_counter()
# 0.995 in a step of 0.2 s looks 40 s ahead: back out of a dead end, and to where the maze goes on.
# On a path it is enough to look 10 s ahead: around the next box.
BEAMS, WIDTH, DISCOUNT, LAMBDA, CLIP, EPOCHS = 180, args.width, 0.98 if args.path else 0.995, 0.95, 0.2, 3
FASTEST_RATE = 8e-4  # of learning; it falls to nearly 0
TASK = {"robot": "nova_carter", "beams": BEAMS, "period_s": 0.2, "goal_tolerance": 0.25, "critic": True}
NORMALISATION = {"goal": ([0.0, 0.0, 0.0], [10.0, 1.0, 1.0]), "velocity": ([0.0, 0.0], [0.8, 0.7])}
POINTS = 8 if args.path else 0
KINDS = ("office", "warehouse") if args.path else ("maze", "office")
if args.path:
    TASK |= {"path_points": POINTS, "unmapped_boxes": 20}
    NORMALISATION["path"] = ([0.0] * 2 * POINTS, [3.0] * 2 * POINTS)
SEEN, KNOWN = BEAMS + 5 + 2 * POINTS, 3
device = torch.device(args.device)
torch.manual_seed(args.seed)
torch.set_float32_matmul_precision("high")
SCALES = torch.tensor([each for _, scale in NORMALISATION.values() for each in scale], device=device)
# In training half of the robots live in mirrored worlds, as many again: beams in reverse order, left and right swapped.
# This needs a lidar that looks straight ahead or back all round, on the axis of a robot whose sides are equal.
REVERSED = (-torch.arange(BEAMS, device=device)) % BEAMS
LATERAL = torch.tensor([0, 0, 1] + [0, 1] * (1 + POINTS), dtype=torch.bool, device=device)  # of goal, velocity, path


class Network(nn.Module):
    """Observations → GRU → action; the value also sees length and direction of the shortest path."""

    def __init__(self) -> None:
        super().__init__()
        self.encoder = nn.Sequential(nn.Linear(SEEN, WIDTH), nn.ELU(), nn.Linear(WIDTH, WIDTH), nn.ELU())
        self.memory = nn.GRUCell(WIDTH, WIDTH)
        self.action = nn.Linear(WIDTH, 2)
        self.value = nn.Sequential(nn.Linear(WIDTH + KNOWN, WIDTH), nn.ELU(), nn.Linear(WIDTH, 1))
        self.log_std = nn.Parameter(torch.full((2,), -0.5))
        nn.init.orthogonal_(self.action.weight, 0.01)
        self.action.bias.data = torch.tensor([0.5, 0.0])  # a robot that begins by driving forwards sees more

    def forward(self, seen: torch.Tensor, known: torch.Tensor, begun: torch.Tensor, state: torch.Tensor):
        """Follow sequences, shape (steps, robots, …); return mean actions, values and the states."""
        states = []
        for encoded, is_first in zip(self.encoder(seen), begun, strict=True):
            state = self.memory(encoded, state * ~is_first[:, None])
            states.append(state)
        states = torch.stack(states)
        return self.action(states), self.value(torch.cat([states, known], dim=-1))[..., 0], states


def as_tensor(values) -> torch.Tensor:
    """Return an array of the environment as a tensor; on a GPU it is one, and float64 becomes float32."""
    tensor = torch.as_tensor(values, device=device)
    return tensor.float() if tensor.is_floating_point() else tensor


def swap_sides(values: torch.Tensor, mirrored: torch.Tensor) -> torch.Tensor:
    """Change the sign of what is to the left or turns there, of the robots that are mirrored."""
    return torch.where(mirrored[:, None] & LATERAL[: values.shape[1]], -values, values)


def look(observed: dict, mirrored: torch.Tensor) -> torch.Tensor:
    """Put what is observed into one tensor, shape (robots, SEEN); near walls differ more than far ones."""
    rest = torch.cat([as_tensor(observed[name]).flatten(1) for name in NORMALISATION], dim=1) / SCALES
    ranges = as_tensor(observed["ranges"]).add(0.1).log()
    ranges = torch.where(mirrored[:, None], ranges[:, REVERSED], ranges)
    return torch.cat([ranges, swap_sides(rest, mirrored)], dim=1)


def know(observed: dict, mirrored: torch.Tensor) -> torch.Tensor:
    """What only the value sees, shape (robots, KNOWN)."""
    return swap_sides(as_tensor(observed["critic"]) / SCALES[:KNOWN], mirrored)


def chance_of(actions: torch.Tensor, mean: torch.Tensor, log_std: torch.Tensor) -> torch.Tensor:
    """Logarithm of the probability density of actions, but for a constant."""
    return -(0.5 * ((actions - mean) / log_std.exp()).square() + log_std).sum(-1)


def drive(env: gymnasium.vector.VectorEnv, actions: torch.Tensor, mirrored: torch.Tensor):
    """Step the environment; actions beyond its bounds are cut off."""
    given = actions.clamp(-1.0, 1.0)
    given = torch.stack([given[:, 0], torch.where(mirrored, -given[:, 1], given[:, 1])], dim=1)
    observed, rewards, terminated, truncated, info = env.step(given if device.type == "cuda" else given.numpy())
    return observed, as_tensor(rewards), as_tensor(terminated), as_tensor(truncated), info


def export(network: Network, env: gymnasium.vector.VectorEnv, path: Path) -> None:
    """Write the policy without its value: the operators of `Network.forward` for one step."""
    from onnx import TensorProto, helper, numpy_helper

    weights = {name: value.detach().cpu().numpy() for name, value in network.state_dict().items()}
    swap = np.r_[WIDTH : 2 * WIDTH, 0:WIDTH, 2 * WIDTH : 3 * WIDTH]  # PyTorch has reset, update, new; ONNX update first
    constants = {name: weights[f"{name}"] for name in weights if name.startswith(("encoder", "action"))}
    constants |= {name: weights[f"memory.weight_{part}h"][swap][None] for name, part in (("W", "i"), ("R", "h"))}
    constants["B"] = np.concatenate([weights["memory.bias_ih"][swap], weights["memory.bias_hh"][swap]])[None]
    constants |= {"near": np.array([0.1], np.float32), "axis": np.array([0], np.int64)}
    layer = lambda name, one, out: helper.make_node(  # noqa: E731
        "Gemm", [one, f"{name}.weight", f"{name}.bias"], [out], transB=1
    )
    nodes = [
        helper.make_node("Add", ["ranges", "near"], ["shifted"]),
        helper.make_node("Log", ["shifted"], ["logs"]),
        *([helper.make_node("Flatten", ["path"], ["points"])] if POINTS else []),
        helper.make_node("Concat", ["logs", "goal", "velocity", *(["points"] if POINTS else [])], ["seen"], axis=1),
        layer("encoder.0", "seen", "a"),
        helper.make_node("Elu", ["a"], ["b"]),
        layer("encoder.2", "b", "c"),
        helper.make_node("Elu", ["c"], ["d"]),
        helper.make_node("Unsqueeze", ["d", "axis"], ["e"]),
        helper.make_node(
            "GRU", ["e", "W", "R", "B", "", "memory"], ["", "memory_next"], hidden_size=WIDTH, linear_before_reset=1
        ),
        helper.make_node("Squeeze", ["memory_next", "axis"], ["f"]),
        layer("action", "f", "action"),
    ]
    shapes = {"ranges": ["n", BEAMS], "goal": ["n", 3], "velocity": ["n", 2], "memory": [1, "n", WIDTH]}
    shapes |= {"path": ["n", POINTS, 2]} if POINTS else {}
    results = {"action": ["n", 2], "memory_next": [1, "n", WIDTH]}
    inputs, outputs = (
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in ends.items()]
        for ends in (shapes, results)
    )
    kept = [numpy_helper.from_array(np.ascontiguousarray(value), name) for name, value in constants.items()]
    graph = helper.make_graph(nodes, "policy", inputs, outputs, kept)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    metadata = policy_metadata(env, normalisation=NORMALISATION, states={"memory": "memory_next"})
    helper.set_model_props(model, metadata)
    path.write_bytes(model.SerializeToString())


@torch.no_grad()
def judge(network: Network, kind: str) -> str:
    """Drive the first missions of robots in unseen worlds by the mean action."""
    unseen = {"world": kind, "worlds": max(1, args.judge // 10), "split": "test", "max_time_s": 300.0}
    env = gymnasium.make_vec(
        "trundle/Navigation-v0", num_envs=args.judge, device=str(device), **unseen, **(TASK | {"critic": False})
    )
    observed, _ = env.reset(seed=10_000)
    state, nothing = torch.zeros(args.judge, WIDTH, device=device), torch.zeros(1, args.judge, KNOWN, device=device)
    fresh = torch.zeros(1, args.judge, dtype=torch.bool, device=device)
    over, arrived, soon, touched, no = (torch.zeros(args.judge, dtype=torch.bool, device=device) for _ in range(5))
    spl = torch.zeros(args.judge, device=device)
    while not over.all():
        mean, _, states = network(look(observed, no)[None], nothing, fresh, state)
        state = states[-1]
        observed, _, terminated, truncated, info = drive(env, mean[0], no)
        success = ~over & as_tensor(info["is_success"])
        arrived |= success
        soon |= success & (as_tensor(info["time_s"]) <= 120.0)
        touched |= ~over & (as_tensor(info["contact"]) | as_tensor(info["off_map"]))
        spl += ~over * as_tensor(info["spl"])
        over |= terminated | truncated
    shares = [each.float().mean().item() for each in (arrived, soon, touched, spl)]
    return (
        f"{kind}: {shares[0]:.1%} of {args.judge} unseen missions arrived within 300 s ({shares[1]:.1%} within 120 s), "
        f"{shares[2]:.1%} touched something, SPL {shares[3]:.3f}"
    )


env = gymnasium.make_vec(
    "trundle/Navigation-v0",
    num_envs=args.envs,
    world=list(KINDS),
    worlds=[args.worlds, args.worlds] if args.path else [2 * args.worlds, args.worlds],  # mazes differ more
    seed=args.seed,
    max_time_s=200.0,
    device=str(device),
    **TASK,
)
network = Network().to(device)
rate = torch.tensor(FASTEST_RATE, device=device)
optimizer = torch.optim.Adam(network.parameters(), lr=rate, eps=1e-5, fused=True, capturable=device.type == "cuda")
steps, robots = args.steps, args.envs
parts = min(args.parts, robots)


def zeros(*shape: int, dtype: torch.dtype = torch.float32) -> torch.Tensor:
    return torch.zeros(shape, dtype=dtype, device=device)


keep = {
    "seen": zeros(steps, robots, SEEN),
    "known": zeros(steps, robots, KNOWN),
    "actions": zeros(steps, robots, 2),
    **{name: zeros(steps, robots) for name in ("chances", "values", "rewards", "advantages", "returns")},
    **{name: zeros(steps, robots, dtype=torch.bool) for name in ("begun", "counts", "over", "ended")},
}
now = {name: zeros(*keep[name].shape[1:], dtype=keep[name].dtype) for name in ("seen", "known", "begun")}
state, first_state, spread = zeros(robots, WIDTH), zeros(robots, WIDTH), zeros()
part = zeros(robots // parts, dtype=torch.int64)
mirrored = torch.arange(robots, device=device) % 2 == 1


@torch.no_grad()
def act() -> tuple[torch.Tensor, ...]:
    """Draw the actions of all robots by what they see `now`, and go on with their state."""
    mean, value, states = network(*(each[None] for each in now.values()), state)
    state.copy_(states[-1])
    action = mean[0] + network.log_std.exp() * torch.randn_like(mean[0])
    return action, chance_of(action, mean[0], network.log_std), value[0]


def learn() -> None:
    """Take one step along the gradient of a `part` of the robots."""
    optimizer.zero_grad()
    mean, value, _ = network(*(keep[name][:, part] for name in now), first_state[part])
    ratio = (chance_of(keep["actions"][:, part], mean, network.log_std) - keep["chances"][:, part]).exp()
    better, counts = keep["advantages"][:, part], keep["counts"][:, part]
    gain = torch.minimum(ratio * better, ratio.clamp(1.0 - CLIP, 1.0 + CLIP) * better)
    miss = (value - keep["returns"][:, part]).square()
    loss = ((0.5 * miss - gain) * counts).sum() / counts.sum()
    (loss - spread * network.log_std.sum()).backward()
    nn.utils.clip_grad_norm_(network.parameters(), 0.5)
    optimizer.step()


def recorded(work):
    """Return a function's kernels as one launch: on a GPU hundreds of small ones wait for the host.

    The function is run three times before that, as a recording of CUDA demands.
    """
    if device.type != "cuda":
        return work
    aside = torch.cuda.Stream()
    aside.wait_stream(torch.cuda.current_stream())
    with torch.cuda.stream(aside):
        for _ in range(3):
            work()
    torch.cuda.current_stream().wait_stream(aside)
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph):
        results = work()
    return lambda: (graph.replay(), results)[1]


def take(observed: dict, begun: torch.Tensor) -> None:
    """Make what is observed what the robots see `now`."""
    for name, values in (("seen", look(observed, mirrored)), ("known", know(observed, mirrored)), ("begun", begun)):
        now[name].copy_(values)


observed, info = env.reset(seed=1_000_000 * args.seed)
begun, ended = (torch.full((robots,), value, device=device) for value in (True, False))
take(observed, begun)
draw, train = recorded(act), None
clocks = {"environment": 0.0, "inference": 0.0, "learner": 0.0}
reported = time.perf_counter()
total, figures = 0, torch.zeros(3, device=device)
print(f"ready after {reported - start:.0f} s", flush=True)


def lap(name: str, is_measured: bool) -> None:
    """Count the time since the last lap as time of this part; on a GPU this waits, so only some updates do it."""
    global reported
    if is_measured:
        if device.type == "cuda":
            torch.cuda.synchronize()
        clocks[name] += time.perf_counter() - reported
        reported = time.perf_counter()


for update in range(args.updates):
    done = (time.perf_counter() - start) / (60.0 * args.minutes)
    if done >= 1.0:
        break
    is_measured = update % 20 == 19 or update + 1 == args.updates
    if is_measured and device.type == "cuda":
        torch.cuda.synchronize()
    reported = time.perf_counter()
    first_state.copy_(state)
    for step in range(steps):
        take(observed, begun)
        action, chances, values = draw()
        for name, each in (now | {"actions": action, "chances": chances, "values": values}).items():
            keep[name][step] = each
        lap("inference", is_measured)
        # The step after the end of an episode begins the next one, and its action does not count.
        begun, keep["counts"][step] = ended, ~ended
        observed, rewards, terminated, truncated, info = drive(env, action, mirrored)
        ended = terminated | truncated
        lap("environment", is_measured)
        # At first a contact costs less: a robot that fears walls before it knows how to drive learns to stand still.
        rewards = rewards - max(0.0, 0.8 - 4.0 * done) * as_tensor(info["reward/contact"])
        for name, each in (("rewards", 0.1 * rewards), ("over", terminated), ("ended", ended)):
            keep[name][step] = each
        figures += torch.stack(
            [(ended & as_tensor(info[name])).sum() for name in ("is_success", "contact")] + [ended.sum()]
        )
    with torch.no_grad():
        after = look(observed, mirrored)[None], know(observed, mirrored)[None]
        following = network(*after, begun[None], state)[1][0]
        later = zeros(robots)
        for step in reversed(range(steps)):
            gain = keep["rewards"][step] + DISCOUNT * following * ~keep["over"][step] - keep["values"][step]
            keep["advantages"][step] = later = gain + DISCOUNT * LAMBDA * later * ~keep["ended"][step]
            following = keep["values"][step]
        keep["returns"].copy_(keep["advantages"] + keep["values"])
        counted = keep["advantages"][keep["counts"]]
        keep["advantages"].sub_(counted.mean()).div_(counted.std() + 1e-6)
    rate.fill_(FASTEST_RATE * max(0.02, 1.0 - done))
    spread.fill_(0.003 * (1.0 - done))
    for _ in range(EPOCHS):
        for chosen in torch.randperm(robots, device=device)[: parts * len(part)].view(parts, -1):
            part.copy_(chosen)
            train = train or recorded(learn)
            train()
    lap("learner", is_measured)
    total += steps * robots
    if is_measured:
        count = figures[2].clamp(min=1.0)
        arrived, touched = (figures[:2] / count).tolist()
        speeds = ", ".join(f"{name} {steps * robots / seconds:,.0f}" for name, seconds in clocks.items())
        print(
            f"{time.perf_counter() - start:.0f} s, {total:,} steps; of {count.item():.0f} episodes {arrived:.1%} "
            f"arrived, {touched:.1%} touched; {speeds} /s",
            flush=True,
        )
        clocks = dict.fromkeys(clocks, 0.0)
        figures.zero_()
export(network, env, Path(args.out))
minutes, of_cores = (time.perf_counter() - start) / 60.0, time.process_time() / 60.0
print(f"{total:,} steps in {minutes:.1f} minutes, {of_cores:.1f} of CPU, on {device}: {args.out}", flush=True)
for kind in KINDS if args.judge else ():
    print(judge(network, kind), flush=True)
