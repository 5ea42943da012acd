import trundle

suite = trundle.Suite(
    worlds="warehouse", seeds="0:2", controllers=["regulated_pure_pursuit", "lookahead"], backends="kinematic"
)
with trundle.evaluate(suite, out="compared") as evaluation:
    for row in evaluation.rows():
        print(row.controller, row.seed, row.outcome, row.time_s)
    print(evaluation.success)
