"""A stand-in for Isaac Sim, made of the signatures that trundle keeps of it, and moved by the kinematic model.

Every module, class and function of it comes from src/trundle/sim/isaac/signatures.yaml, so that a call, a keyword, an
order or a shape of an array that Isaac Sim would not take is refused here too; so is a call at a time when Isaac Sim
would not take it: an import before the application runs, physics before the timeline plays, anything after the end.
The stage is a real one (usd-core stands in for Kit's own USD).
"""
