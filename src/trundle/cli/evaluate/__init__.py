"""`trundle evaluate`: thousands of missions, run, compared and judged."""

from trundle.cli.evaluate.run import app

for _name, _target, _help in (
    ("report", "results:report_app", "Write report.html, junit.xml and summary.json."),
    ("compare", "results:compare_app", "Compare two evaluations of the same missions."),
    ("show", "results:show_app", "List episodes, each with the command that repeats it."),
    ("barn", "public:barn_app", "Drive in the public BARN worlds."),
    ("dynabarn", "public:dynabarn_app", "Drive among DynaBARN's moving cylinders."),
):
    app.command(f"trundle.cli.evaluate.{_target}", name=_name, help=_help)

__all__ = ["app"]
