# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
