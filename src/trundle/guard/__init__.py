"""Reading untrusted files in a separate process, with limits on time and memory.

The libraries that read USD, MJCF and meshes are native, and a bad file can crash them, hang them or exhaust the memory.
Here that happens to a child process: it gets the name of a trundle function and its arguments, and returns the result
with all warnings and errors. The child protects against accidents and bad files; it is not a sandbox, and its replies
are trusted. `process` starts this child and those of other packages.
"""

from trundle.guard.reading import Child, ReadCall, ReadLimits, in_kit, read_guarded, read_limits

__all__ = ["Child", "ReadCall", "ReadLimits", "in_kit", "read_guarded", "read_limits"]
