"""Train a recurrent policy with RSL-RL's own runner: pip install ".[gym,gpu]" rsl-rl-lib; gpu is for --device cuda."""

import argparse

import torch
from rsl_rl.runners import OnPolicyRunner

from trundle.gym.rsl_rl import RslRlVecEnv

parser = argparse.ArgumentParser()
parser.add_argument("--device", default="cpu", help="cuda: the environment and the learner on one GPU")
parser.add_argument("--envs", type=int, default=1024)
parser.add_argument("--iterations", type=int, default=500)
parser.add_argument("--steps", type=int, default=32, help="of each iteration")
parser.add_argument("--worlds", type=int, default=50)
parser.add_argument("--seed", type=int, default=0, help="of the missions, the network and the actions")
parser.add_argument("--log", help="folder for TensorBoard's logs and checkpoints")
args = parser.parse_args()

torch.manual_seed(args.seed)
worlds = {"world": "office", "worlds": args.worlds}
env = RslRlVecEnv(args.envs, reset_seed=1_000_000 * args.seed, robot="nova_carter", device=args.device, **worlds)
network = {"class_name": "RNNModel", "rnn_type": "gru", "rnn_hidden_dim": 256, "hidden_dims": [256]}
gaussian = {"class_name": "GaussianDistribution", "init_std": 0.6, "std_type": "log"}
config = {
    "num_steps_per_env": args.steps,
    "save_interval": 50,
    "obs_groups": {"actor": ["actor"], "critic": ["critic"]},
    "actor": {**network, "obs_normalization": True, "distribution_cfg": gaussian},
    "critic": {**network, "obs_normalization": True},
    "algorithm": {"class_name": "PPO", "num_learning_epochs": 3, "num_mini_batches": 4, "learning_rate": 5e-4},
}
runner = OnPolicyRunner(env, config, log_dir=args.log, device=args.device)
runner.learn(args.iterations, init_at_random_ep_len=True)
print(f"learned for {args.iterations} iterations on {args.device}")
