"""`trundle evaluate`: thousands of missions, run, compared and judged."""

from trundle.cli.evaluate.run import app

app.command("trundle.cli.evaluate.report:app", name="report", help="Write report.html, junit.xml and summary.json.")
app.command("trundle.cli.evaluate.compare:app", name="compare", help="Compare two evaluations of the same missions.")
app.command("trundle.cli.evaluate.show:app", name="show", help="List episodes, each with the command that repeats it.")
app.command("trundle.cli.evaluate.barn:app", name="barn", help="Drive in the public BARN worlds.")
app.command("trundle.cli.evaluate.dynabarn:app", name="dynabarn", help="Drive among DynaBARN's moving cylinders.")

__all__ = ["app"]
