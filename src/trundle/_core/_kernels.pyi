"""Signatures of the compiled kernels."""

import numpy as np
import numpy.typing as npt

def inflate(cells: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]: ...
def png_unfilter(lines: npt.NDArray[np.uint8], step: int) -> npt.NDArray[np.uint8]: ...
