"""Gymnasium environments on trundle's worlds: `import trundle.gym` registers them.

`trundle/Navigation-v0`, `trundle/Barn-v0` and `trundle/DynaBarn-v0`; needs the extra `gym`.
"""

from trundle.extras import check_extra

check_extra("gym", "trundle.gym")

import gymnasium  # noqa: E402 - after the check

from trundle.gym.env import NavigationEnv  # noqa: E402
from trundle.gym.navigation_settings import REWARD_TERMS, NavigationSettings  # noqa: E402
from trundle.gym.policy import policy_metadata  # noqa: E402
from trundle.gym.vector_env import NavigationVectorEnv  # noqa: E402

_ENTRIES = {
    "trundle/Navigation-v0": ("env:NavigationEnv", "vector_env:NavigationVectorEnv"),
    "trundle/Barn-v0": ("public_worlds:make_barn", "public_worlds:make_barn_vector"),
    "trundle/DynaBarn-v0": ("public_worlds:make_dynabarn", "public_worlds:make_dynabarn_vector"),
}

for _name, (_single, _many) in _ENTRIES.items():
    if _name not in gymnasium.registry:
        gymnasium.register(_name, entry_point=f"trundle.gym.{_single}", vector_entry_point=f"trundle.gym.{_many}")

__all__ = ["REWARD_TERMS", "NavigationEnv", "NavigationSettings", "NavigationVectorEnv", "policy_metadata"]
