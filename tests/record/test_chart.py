"""Axes of charts: what is nearly equal looks equal."""

import numpy as np
import pytest
from PIL import ImageDraw

from trundle.record.compare import Chart, Curve, draw_chart, round_marks

TIME = np.linspace(0.0, 5.0, 101)


def labels(monkeypatch, chart):
    """The numbers at the axes."""
    seen = []
    write = ImageDraw.ImageDraw.text

    def note(self, at, text, **options):
        seen.append(text)
        return write(self, at, text, **options)

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", note)
    draw_chart(chart, (620, 210))
    return [text for text in seen if text != "title"]


@pytest.mark.parametrize("square", [False, True])
@pytest.mark.parametrize("zero", [False, True])
@pytest.mark.parametrize("offset", [0.0, 0.3])
@pytest.mark.parametrize("noise", [0.0, 1e-16, -1e-10])
def test_an_axis_never_spans_rounding_errors(monkeypatch, square, zero, offset, noise):
    y = offset + noise * np.sin(TIME)
    chart = Chart("title", [Curve(TIME, y, (0, 0, 0), "")], square=square, zero=zero, least=0.1)
    texts = labels(monkeypatch, chart)
    assert len(texts) > 4
    assert not any("e" in text or text == "-0" for text in texts)
    rows = [float(text) for text in texts]
    assert max(rows) - min(rows) >= 0.08


def test_a_standing_robot_is_no_point_on_axes_of_nothing(monkeypatch):
    stands = np.full(101, 2.0)
    texts = labels(monkeypatch, Chart("title", [Curve(stands, stands, (0, 0, 0), "")], square=True, least=0.1))
    assert not any("e" in text for text in texts)
    assert all(1.5 < float(text) < 2.5 for text in texts)


def test_differences_above_the_least_span_fill_the_chart(monkeypatch):
    chart = Chart("title", [Curve(TIME, 3.0 * TIME, (0, 0, 0), "")], zero=True, least=0.1)
    assert "15" in labels(monkeypatch, chart)


def test_no_mark_is_minus_zero():
    assert [str(mark) for mark in round_marks(-0.1, 0.1)].count("-0.0") == 0
