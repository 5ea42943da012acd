"""Train a policy that drives to goals without a map: recurrent PPO on a vector environment, exported as policy.onnx.

Needs the extra gym, PyTorch and onnx. --updates 2 --envs 16 is a short try; ten minutes on a GPU give a policy.
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
parser.add_argument("--minutes", type=float, default=9.0)
parser.add_argument("--updates", type=int, default=1_000_000)
parser.add_argument("--envs", type=int, default=2048)
parser.add_argument("--steps", type=int, default=32, help="of each update; the state is carried on, gradients are not")
parser.add_argument("--worlds", type=int, default=100, help="mazes, and as many offices")
parser.add_argument("--judge", type=int, default=500, help="missions of each kind in unseen worlds")
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--out", default="policy.onnx")
args = parser.parse_args()

BEAMS, WIDTH, DISCOUNT, LAMBDA, CLIP, EPOCHS, PARTS = 180, 256, 0.99, 0.95, 0.2, 3, 8
FASTEST_RATE = 8e-4  # of learning; it falls to nearly 0
TASK = {"robot": "nova_carter", "beams": BEAMS, "period_s": 0.2, "goal_tolerance": 0.25}
NORMALISATION = {"goal": ([0.0, 0.0, 0.0], [10.0, 1.0, 1.0]), "velocity": ([0.0, 0.0], [0.8, 0.7])}
device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
torch.manual_seed(args.seed)
torch.set_float32_matmul_precision("high")


class Network(nn.Module):
    """Observations → GRU → action; the value also sees the length of the shortest path, which a robot cannot know."""

    def __init__(self) -> None:
        super().__init__()
        self.encoder = nn.Sequential(nn.Linear(BEAMS + 5, WIDTH), nn.ELU(), nn.Linear(WIDTH, WIDTH), nn.ELU())
        self.memory = nn.GRUCell(WIDTH, WIDTH)
        self.action = nn.Linear(WIDTH, 2)
        self.value = nn.Sequential(nn.Linear(WIDTH + 1, WIDTH), nn.ELU(), nn.Linear(WIDTH, 1))
        self.log_std = nn.Parameter(torch.full((2,), -0.5))
        nn.init.orthogonal_(self.action.weight, 0.01)
        self.action.bias.data = torch.tensor([0.5, 0.0])  # a robot that begins by driving forwards sees more

    def forward(self, seen: torch.Tensor, distance: torch.Tensor, begun: torch.Tensor, state: torch.Tensor):
        """Follow sequences, shape (steps, robots, …); return mean actions, values and the last state."""
        encoded, states = self.encoder(seen), []
        for step, fresh in enumerate(begun):
            state = self.memory(encoded[step], state * ~fresh[:, None])
            states.append(state)
        known = torch.stack(states)
        value = self.value(torch.cat([known, distance[..., None] / 10.0], dim=-1))[..., 0]
        return self.action(known), value, state


def look(observed: dict[str, np.ndarray]) -> torch.Tensor:
    """Put what is observed into one tensor, shape (robots, BEAMS + 5); near walls differ more than far ones."""
    parts = [torch.from_numpy(observed["ranges"]).to(device).add(0.1).log()]
    for name, (_, scale) in NORMALISATION.items():
        parts.append(torch.from_numpy(observed[name] / np.array(scale, dtype=np.float32)).to(device))
    return torch.cat(parts, dim=1)


def as_tensor(values: np.ndarray) -> torch.Tensor:
    return torch.as_tensor(values, dtype=torch.bool if values.dtype == bool else torch.float32, device=device)


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
        helper.make_node("Concat", ["logs", "goal", "velocity"], ["seen"], axis=1),
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
    env = gymnasium.make_vec("trundle/Navigation-v0", num_envs=args.judge, **unseen, **TASK)
    observed, info = env.reset(seed=10_000)
    state = torch.zeros(args.judge, WIDTH, device=device)
    over, arrived, touched = (np.zeros(args.judge, dtype=bool) for _ in range(3))
    spl, times = np.zeros(args.judge), np.zeros(args.judge)
    while not over.all():
        fresh = torch.zeros(1, args.judge, dtype=torch.bool, device=device)
        mean, _, state = network(look(observed)[None], as_tensor(info["distance_to_goal"])[None], fresh, state)
        observed, _, terminated, truncated, info = env.step(mean[0].clamp(-1.0, 1.0).cpu().numpy())
        arrived |= ~over & info["is_success"]
        touched |= ~over & (info["contact"] | info["off_map"])
        spl += ~over * info["spl"]
        times = np.where(over, times, info["time_s"])
        over |= terminated | truncated
    soon = (arrived & (times <= 120.0)).mean()
    return (
        f"{kind}: {arrived.mean():.1%} of {args.judge} unseen missions arrived ({soon:.1%} "
        f"within 120 s), {touched.mean():.1%} touched something, SPL {spl.mean():.3f}"
    )


env = gymnasium.make_vec(
    "trundle/Navigation-v0",
    num_envs=args.envs,
    world=["maze", "office"],
    worlds=args.worlds,
    seed=args.seed,
    **TASK,
)
network = Network().to(device)
optimizer = torch.optim.Adam(network.parameters(), lr=FASTEST_RATE, eps=1e-5)
steps, robots = args.steps, args.envs
keep = {
    "seen": torch.zeros(steps, robots, BEAMS + 5, device=device),
    "actions": torch.zeros(steps, robots, 2, device=device),
    **{name: torch.zeros(steps, robots, device=device) for name in ("distance", "chances", "values", "rewards")},
    **{name: torch.zeros(steps, robots, dtype=torch.bool, device=device) for name in ("begun", "counts", "over")},
    "ended": torch.zeros(steps, robots, dtype=torch.bool, device=device),
}
observed, info = env.reset(seed=1_000_000 * args.seed)
state = torch.zeros(robots, WIDTH, device=device)
begun, ended = np.ones(robots, dtype=bool), np.zeros(robots, dtype=bool)
clocks = {"environment": 0.0, "inference": 0.0, "learner": 0.0}
start = reported = time.perf_counter()
total, since, episodes = 0, 0, []


def lap(name: str) -> None:
    """Count the time since the last lap as time of this part."""
    global reported
    if device.type == "cuda":
        torch.cuda.synchronize()
    now = time.perf_counter()
    clocks[name] += now - reported
    reported = now


for update in range(args.updates):
    done = (time.perf_counter() - start) / (60.0 * args.minutes)
    if done >= 1.0:
        break
    first_state = state
    for step in range(steps):
        with torch.no_grad():
            now = {"seen": look(observed), "distance": as_tensor(info["distance_to_goal"]), "begun": as_tensor(begun)}
            mean, value, state = network(*(each[None] for each in now.values()), state)
            noise = torch.distributions.Normal(mean[0], network.log_std.exp())
            action = noise.sample()
            now |= {"actions": action, "chances": noise.log_prob(action).sum(-1), "values": value[0]}
            given = action.clamp(-1.0, 1.0).cpu().numpy()
        lap("inference")
        # The step after the end of an episode begins the next one, and its action does not count.
        begun, counts = ended, ~ended
        observed, rewards, terminated, truncated, info = env.step(given)
        ended = terminated | truncated
        lap("environment")
        # At first a contact costs less: a robot that fears walls before it knows how to drive learns to stand still.
        rewards = rewards - max(0.0, 0.8 - 4.0 * done) * info["reward/contact"]
        now |= {"rewards": as_tensor(0.1 * rewards), "counts": as_tensor(counts)}
        now |= {"over": as_tensor(terminated), "ended": as_tensor(ended)}
        for name, values in now.items():
            keep[name][step] = values
        episodes += list(zip(info["is_success"][ended], info["contact"][ended], strict=True))
    with torch.no_grad():
        ahead = as_tensor(info["distance_to_goal"])[None]
        following = network(look(observed)[None], ahead, as_tensor(begun)[None], state)[1][0]
        advantages, later = torch.zeros(steps, robots, device=device), torch.zeros(robots, device=device)
        for step in reversed(range(steps)):
            gain = keep["rewards"][step] + DISCOUNT * following * ~keep["over"][step] - keep["values"][step]
            advantages[step] = later = gain + DISCOUNT * LAMBDA * later * ~keep["ended"][step]
            following = keep["values"][step]
        returns = advantages + keep["values"]
        counted = advantages[keep["counts"]]
        advantages = (advantages - counted.mean()) / (counted.std() + 1e-6)
    for group in optimizer.param_groups:
        group["lr"] = FASTEST_RATE * max(0.02, 1.0 - done)
    for _ in range(EPOCHS):
        for part in torch.randperm(robots, device=device).chunk(PARTS):
            mean, value, _ = network(
                *(keep[name][:, part] for name in ("seen", "distance", "begun")), first_state[part]
            )
            noise = torch.distributions.Normal(mean, network.log_std.exp())
            ratio = (noise.log_prob(keep["actions"][:, part]).sum(-1) - keep["chances"][:, part]).exp()
            better, counts_here = advantages[:, part], keep["counts"][:, part]
            gain = torch.minimum(ratio * better, ratio.clamp(1.0 - CLIP, 1.0 + CLIP) * better)
            miss = (value - returns[:, part]).square()
            loss = ((0.5 * miss - gain) * counts_here).sum() / counts_here.sum()
            loss = loss - 0.003 * (1.0 - done) * network.log_std.sum()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), 0.5)
            optimizer.step()
    lap("learner")
    total, since = total + steps * robots, since + steps * robots
    if update % 20 == 19 or update + 1 == args.updates:
        arrived, touched = np.mean(episodes, axis=0) if episodes else (0.0, 0.0)
        speeds = ", ".join(f"{name} {since / seconds:,.0f}" for name, seconds in clocks.items())
        print(f"{total:,} steps, {len(episodes)} episodes: {arrived:.1%} arrived, {touched:.1%} touched; {speeds} /s")
        clocks, since, episodes = dict.fromkeys(clocks, 0.0), 0, []
export(network, env, Path(args.out))
print(f"trained for {(time.perf_counter() - start) / 60.0:.1f} minutes on {device}: {args.out}")
for kind in ("maze", "office") if args.judge else ():
    print(judge(network, kind))
