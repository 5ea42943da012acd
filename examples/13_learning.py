"""Learn to follow a path by the cross-entropy method: each robot of a vector environment tries a policy.

Needs the extra gym. --generations 2 is a short try.
"""

import argparse

import gymnasium
import numpy as np

import trundle.gym  # noqa: F401 - registers the environments

parser = argparse.ArgumentParser()
parser.add_argument("--generations", type=int, default=12)

ROBOTS, STEPS = 256, 150
world = {"world": "office", "robot": "jackal", "beams": 60, "path_points": 2, "min_distance": 3.0}
env = gymnasium.make_vec("trundle/Navigation-v0", num_envs=ROBOTS, rewards={"progress": 1.0}, **world)
rng = np.random.default_rng(0)
mean, spread = np.zeros((3, 2)), np.ones((3, 2))
for generation in range(parser.parse_args().generations):
    weights = mean + spread * rng.normal(size=(ROBOTS, *mean.shape))
    observed, _ = env.reset(seed=generation * ROBOTS)
    reward, alive, arrived = np.zeros(ROBOTS), np.ones(ROBOTS, dtype=bool), np.zeros(ROBOTS, dtype=bool)
    for _ in range(STEPS):
        seen = np.column_stack([observed["path"][:, 1], np.ones(ROBOTS)])  # the point 1 m ahead on the path
        actions = np.tanh(np.einsum("nf,nfa->na", seen, weights)).astype(np.float32)
        observed, rewards, terminated, truncated, info = env.step(actions)
        reward, arrived = reward + rewards * alive, arrived | (alive & info["is_success"])
        alive &= ~(terminated | truncated)
    best = np.argsort(-reward)[: ROBOTS // 8]
    mean, spread = weights[best].mean(axis=0), weights[best].std(axis=0)
    print(f"generation {generation + 1}: reward {reward.mean():.2f}, {arrived.mean():.0%} arrived")
