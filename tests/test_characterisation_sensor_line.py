"""The sensor's line: truth is covered, bounds are exact, and bad data are refused."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.feasible_lines import (
    FeasibleSetStatus,
    feasible_lines,
)
from flegx_models.characterisation.sensor_line import Line, least_squares_line

TRUE = Line(17.9, -0.06)
FloatArray = NDArray[np.float64]


def points(
    seed: int, *, output_error: float, input_error: float = 0.0, number: int = 15
) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 5.5, number)
    y = TRUE(u) + rng.uniform(-output_error, output_error, number)
    return u + rng.uniform(-input_error, input_error, number), y


def test_least_squares_agree_with_the_normal_equations() -> None:
    u, y = points(0, output_error=0.5)
    found = least_squares_line(u, y)
    matrix = np.column_stack([u, np.ones_like(u)])
    theta = np.linalg.solve(matrix.T @ matrix, matrix.T @ y)
    np.testing.assert_allclose([found.line.slope, found.line.offset], theta)
    cov = found.residual_std**2 * np.linalg.inv(matrix.T @ matrix)
    np.testing.assert_allclose(found.covariance, cov)


def test_confidence_intervals_cover_the_truth_as_often_as_they_say() -> None:
    u = np.linspace(0.0, 5.5, 8)
    rng = np.random.default_rng(7)
    hits = np.zeros(2)
    runs = 2000
    for _ in range(runs):
        found = least_squares_line(u, TRUE(u) + rng.normal(0, 0.3, len(u)))
        for k, (interval, true) in enumerate(
            zip(found.intervals(0.95), (TRUE.slope, TRUE.offset), strict=True)
        ):
            hits[k] += interval[0] <= true <= interval[1]
    # 95 % ± 4 standard errors of 2000 draws.
    assert np.all(np.abs(hits / runs - 0.95) < 4 * np.sqrt(0.95 * 0.05 / runs))


@pytest.mark.parametrize("input_error", [0.0, 0.05])
def test_bounded_errors_always_leave_the_truth_possible(input_error: float) -> None:
    for seed in range(60):
        u, y = points(seed, output_error=0.5, input_error=input_error)
        found = feasible_lines(u, y, output_error=0.5, input_error=input_error)
        assert found.status is FeasibleSetStatus.BOUNDED
        assert found.contains(TRUE)
        assert found.slack >= 0


@pytest.mark.parametrize("input_error", [0.0, 0.05])
def test_the_boxs_sides_are_touched_and_its_corners_are_possible(
    input_error: float,
) -> None:
    u, y = points(3, output_error=0.5, input_error=input_error)
    found = feasible_lines(u, y, output_error=0.5, input_error=input_error)
    (polygon,) = found.polygons
    corners = np.array(polygon)
    np.testing.assert_allclose(
        [corners.min(axis=0), corners.max(axis=0)],
        np.transpose([found.slope, found.offset]),
        atol=1e-6,
    )
    for slope, offset in polygon:
        miss = np.abs(y - slope * u - offset) - 0.5 - abs(slope) * input_error
        assert np.max(miss) < 1e-6
    assert found.centre is not None
    assert found.centre.slope == pytest.approx(np.mean([found.slope]))


def test_no_search_over_all_errors_goes_past_the_exact_bounds() -> None:
    """The polynomial problem itself, solved locally in its 2N + 2 unknowns."""
    n, input_error, output_error = 6, 0.1, 0.6
    u, y = points(11, output_error=output_error, input_error=input_error, number=n)
    exact = feasible_lines(u, y, output_error=output_error, input_error=input_error)
    assert exact.slope is not None
    assert exact.offset is not None
    start = least_squares_line(u, y).line
    bounds = (
        [(None, None)] * 2
        + [(-input_error, input_error)] * n
        + [(-output_error, output_error)] * n
    )

    def misfit(z: FloatArray) -> FloatArray:
        a, b, xi, eta = z[0], z[1], z[2 : 2 + n], z[2 + n :]
        return np.asarray(y - eta - a * (u - xi) - b)

    for index, (low, high) in enumerate((exact.slope, exact.offset)):
        for sign, bound in ((1, low), (-1, high)):
            result = minimize(
                lambda z, i=index, s=sign: s * z[i],
                np.array([start.slope, start.offset, *np.zeros(2 * n)]),
                bounds=bounds,
                constraints={"type": "eq", "fun": misfit},
                method="SLSQP",
                options={"maxiter": 500, "ftol": 1e-9},
            )
            assert result.success
            reached = sign * result.fun
            assert sign * (reached - bound) > -1e-6
            assert reached == pytest.approx(bound, abs=1e-4)


def test_a_slope_of_either_sign_gives_two_polygons() -> None:
    u = np.linspace(0.0, 5.0, 9)
    found = feasible_lines(u, 0 * u, output_error=0.1, input_error=0.2)
    assert len(found.polygons) == 2
    assert found.slope == pytest.approx((-0.1 / 2.3, 0.1 / 2.3))
    assert found.centre is not None
    assert found.centre.slope == pytest.approx(0.0, abs=1e-12)


def test_input_errors_widen_the_set_and_vanish_with_their_bound() -> None:
    u, y = points(5, output_error=0.4)
    widths = []
    for bound in (0.0, 1e-9, 0.02, 0.1):
        found = feasible_lines(u, y, output_error=0.4, input_error=bound)
        assert found.slope is not None
        widths.append(found.slope[1] - found.slope[0])
    assert widths[0] == pytest.approx(widths[1], rel=1e-5)
    assert widths[1] < widths[2] < widths[3]


def test_too_small_a_bound_is_an_answer_that_says_by_how_much() -> None:
    u, y = points(2, output_error=0.5)
    found = feasible_lines(u, y, output_error=0.05)
    assert found.status is FeasibleSetStatus.EMPTY
    assert found.slope is None
    assert found.slack < 0
    needed = 0.05 - found.slack
    assert (
        feasible_lines(u, y, output_error=needed * 1.0001).status
        is FeasibleSetStatus.BOUNDED
    )
    assert (
        feasible_lines(u, y, output_error=needed * 0.9999).status
        is FeasibleSetStatus.EMPTY
    )


def test_inputs_that_may_all_be_the_same_do_not_bound_the_slope() -> None:
    u, y = points(2, output_error=0.5)
    found = feasible_lines(u, y, output_error=0.5, input_error=3.0)
    assert found.status is FeasibleSetStatus.UNBOUNDED
    assert found.centre is None


def test_each_point_may_have_its_own_bounds() -> None:
    u, y = points(4, output_error=0.2)
    y[3] += 5.0
    bounds = np.full(len(u), 0.2)
    assert feasible_lines(u, y, output_error=bounds).status is FeasibleSetStatus.EMPTY
    bounds[3] = 5.2
    assert feasible_lines(u, y, output_error=bounds).contains(TRUE)


@pytest.mark.parametrize(
    ("u", "y", "message"),
    [
        ([1.0, 2.0], [1.0, 2.0], "at least three points"),
        ([1.0, 1.0, 1.0], [1.0, 2.0, 3.0], "same input 1"),
        ([1.0, 2.0, np.nan], [1.0, 2.0, 3.0], "not a number"),
    ],
)
def test_refuses_points_without_a_line(
    u: list[float], y: list[float], message: str
) -> None:
    with pytest.raises(CharacterisationError, match=message):
        least_squares_line(u, y)
    with pytest.raises(CharacterisationError, match=message):
        feasible_lines(u, y, output_error=0.1)


def test_refuses_a_negative_bound() -> None:
    with pytest.raises(CharacterisationError, match="output_error"):
        feasible_lines([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], output_error=-0.1)
