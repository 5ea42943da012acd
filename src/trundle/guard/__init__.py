"""Reading other people's files in a process of their own, with limits on its time and memory.

The libraries that read USD, MJCF and meshes are native, and a bad file can crash them, keep them busy for ever or make
them take all memory. Here that happens to a child: it is given the name of a function of ours and its arguments, and
hands the result back, with the warnings and errors raised meanwhile. The child guards against accidents and bad files;
it is no sandbox, and what it sends is trusted.
"""

from trundle.guard.limits import ReadLimits, read_limits
from trundle.guard.process import Child, ReadCall, in_kit, read_guarded

__all__ = ["Child", "ReadCall", "ReadLimits", "in_kit", "read_guarded", "read_limits"]
