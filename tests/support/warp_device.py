"""Where tests let `device="cuda"` compute: on Warp's CPU device, and on a GPU where there is one."""

import pytest


def is_missing_a_gpu() -> bool:
    import warp as wp

    from trundle.sim.batch import warp as devices

    devices.find_device("cpu")
    return not wp.get_cuda_devices()


@pytest.fixture(params=["cpu", "cuda"])
def device(request, monkeypatch):
    """The kind of device that is asked for as "cuda": Warp's CPU device, or a GPU."""
    from trundle.sim.batch import warp as devices

    if request.param == "cuda" and is_missing_a_gpu():
        pytest.skip("needs a GPU of NVIDIA's")
    find = devices.find_device
    monkeypatch.setattr(devices, "find_device", lambda _name: find(request.param))
    return request.param
