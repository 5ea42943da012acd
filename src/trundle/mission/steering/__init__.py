"""Steering a run in progress: directives, the queue that they are put into, and the loop that paces a run."""
