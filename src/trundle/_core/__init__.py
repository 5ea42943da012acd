"""The C++ kernels: plain functions on arrays. They release the GIL and check their bounds at this edge."""

from trundle._core._kernels import inflate, png_unfilter

__all__ = ["inflate", "png_unfilter"]
