"""Train a policy with PPO of Stable-Baselines3: pip install ".[gym]" stable-baselines3."""

import argparse

from stable_baselines3 import PPO

from trundle.gym.sb3 import Sb3VecEnv

parser = argparse.ArgumentParser()
parser.add_argument("--envs", type=int, default=64)
parser.add_argument("--steps", type=int, default=1_000_000, help="of all robots together")
parser.add_argument("--worlds", type=int, default=50)
parser.add_argument("--out", default="ppo_office")
args = parser.parse_args()

env = Sb3VecEnv(args.envs, world="office", worlds=args.worlds, robot="nova_carter")
model = PPO("MultiInputPolicy", env, n_steps=64, batch_size=1024, n_epochs=4, device="cpu", verbose=1)
model.learn(args.steps)
model.save(args.out)
