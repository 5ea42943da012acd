"""The C++ kernels: plain functions on arrays. They release the GIL and check their bounds at this edge."""

from trundle._core._kernels import *  # noqa: F403 - each kernel of bindings.cpp and _kernels.pyi
