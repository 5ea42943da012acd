"""Evaluation: thousands of missions run, judged and compared."""

__all__: list[str] = []
