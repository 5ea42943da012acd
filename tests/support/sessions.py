"""Sessions that are driven period by period, and what becomes of the tasks that they are given."""


def steps_of(session):
    """Drive a session to its end; its steps."""
    steps = []
    while (step := session.step()) is not None:
        steps.append(step)
    return steps


def drive(session, periods):
    return [session.step() for _ in range(periods)]


def drive_until(session, done, most=2000):
    for _ in range(most):
        step = session.step()
        if done():
            return step
    raise AssertionError(f"not done after {most} periods")


class Watch:
    """Writes down what becomes of a task."""

    def __init__(self):
        self.began, self.refused, self.ended = [], [], []

    def begin(self, time):
        self.began.append(time)

    def refuse(self, error):
        self.refused.append(error)

    def end(self, end):
        self.ended.append(end)

    @property
    def results(self):
        return [end.result for end in self.ended]
