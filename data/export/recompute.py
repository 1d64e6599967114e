#!/usr/bin/env python3
"""Computes the results of a study again, from the CSV files of the folder that this script lies in.

    python3 recompute.py            (or: python3 recompute.py FOLDER)

It needs Python 3.8 or later and nothing else. It is meant to be read: each step from the answers to the group is a
short function. dictionary.csv says what every column of every file means.

    trials.csv, intervals.csv -> cells.csv       how often "different" was said, rates, z, d'
    cells                     -> thresholds.csv  slope of d' on the difference, JND = 1 / slope
    thresholds                -> group.csv       means, intervals, medians over participants
                                 contrasts.csv   conditions against each other, with the registered test
                                 pairs.csv, tests.csv (ratings: from answers.csv), groups.csv

Each step works on what the step before it computed, not on the file. Of the tasks other than same-different, and of
adaptive procedures, the participants' own estimates (estimates.csv, tracks.csv) are taken as they are, and everything
from there on is computed again. So are the JNDs of maximum likelihood (thresholds.csv).

What it prints: for each file how many numbers and words were compared and the largest relative difference; which
columns it does not compute; how many rows it read of how many that were written. It ends with status 1 where a row is
missing, or a number differs by more than 1e-9 of itself; a number next to zero, such as a difference of equal means, may
differ by 1e-14 of the largest number of its column, and a mean by 1e-14 of its spread.

Of the hierarchical model (hierarchical.csv) it computes ln L at the estimates, from the trials and by nodes of its own,
and compares it within 1e-5. The estimates themselves are not searched; instead a small step of any of them, up or down,
must not raise ln L. Variants with lapses, drift, overdispersion or sureness, intervals and tests are not computed.

Bootstrap intervals of single JNDs are drawn at random, from the study's own seed, and are not computed here.
"""
import os
import sys

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path = [place for place in sys.path if os.path.realpath(place) != HERE]  # nothing that lies here is imported

import csv
import functools
import heapq
import math
import operator
import re
from statistics import NormalDist, median

TOLERANCE = 1e-9
NAN = float("nan")
NORMAL = NormalDist()
NEAR_ZERO = 1e-5  # a number next to zero may differ by TOLERANCE of this share of what it comes from
LEAST_SLOPE = 1e-9  # at or below it no difference is noticeable
ROUNDING = 1e-13  # a spread of less than this share of the values is none


# --- Distributions ---------------------------------------------------------------------------------------------------

def z_of(k, n, correction):
    """The normal quantile of the corrected rate k / n. Rates above 1/2 go by their complement: no digit is lost."""
    if 2 * k > n:
        return -z_of(n - k, n, correction)
    rate = corrected_rate(k, n, correction)
    return NORMAL.inv_cdf(rate) if rate > 0 else -math.inf


def beta_fraction(a, b, x):
    """The continued fraction of the incomplete beta function, by Lentz's method (Numerical Recipes, section 6.4)."""
    tiny = 1e-300
    c, d = 1.0, 1 - (a + b) * x / (a + 1)
    d = 1 / (d if abs(d) > tiny else tiny)
    value = d
    for m in range(1, 10000):
        for step in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                     -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1 + step * d
            d = 1 / (d if abs(d) > tiny else tiny)
            c = 1 + step / c
            c = c if abs(c) > tiny else tiny
            value *= c * d
        if abs(c * d - 1) < 1e-16:
            break
    return value


def beta_share(a, b, x, y):
    """The regularised incomplete beta function I_x(a, b); y is 1 - x, given apart for its digits."""
    if x <= 0 or y <= 0:
        return 0.0 if x <= 0 else 1.0
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log(y))
    if x < (a + 1) / (a + b + 2):
        return front * beta_fraction(a, b, x) / a
    return 1 - front * beta_fraction(b, a, y) / b


def t_two_sided(t, df):
    """P(|T| >= |t|) of Student's t."""
    return beta_share(df / 2, 0.5, df / (df + t * t), t * t / (df + t * t))


def t_quantile(df):
    """The t that 95 % of Student's distribution lie within, by bisection."""
    low, high = 0.0, 13.0  # 12.7 with one degree of freedom
    for _ in range(200):
        middle = (low + high) / 2
        if t_two_sided(middle, df) > 0.05:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def f_upper(f, df1, df2):
    """P(F >= f)."""
    if math.isnan(df1):
        return NAN
    return beta_share(df2 / 2, df1 / 2, df2 / (df2 + df1 * f), df1 * f / (df2 + df1 * f))


def chi2_upper(x, df):
    """P(chi-square >= x) with whole degrees of freedom: from those of 1 or 2 upwards, two at a time."""
    odd = df % 2
    share = math.erfc(math.sqrt(x / 2)) if odd else math.exp(-x / 2)
    for k in range(1 if odd else 2, df, 2):
        share += math.exp(k / 2 * math.log(x / 2) - x / 2 - math.lgamma(k / 2 + 1)) if x > 0 else 0
    return share


# --- Files -----------------------------------------------------------------------------------------------------------

class Trouble(Exception):
    """The folder is not as jnd export wrote it."""


ROWS_READ = {}  # by file


def listed():
    """The files that the export holds, by its own list, and how many rows those have that are tables."""
    try:
        with open(os.path.join(FOLDER, "SHA256SUMS"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        rows = [re.match(r"# (\d+) rows: (.*)", line) for line in lines]
        return ({line.split("  ", 1)[1] for line in lines if not line.startswith("#")},
                {said[2]: int(said[1]) for said in rows if said})
    except OSError:
        raise Trouble(f"{FOLDER}: SHA256SUMS is missing: this is no folder of jnd export") from None


def read(name):
    """The rows of a file, as dictionaries of text; none where the export has no such file."""
    if name not in LISTED:
        return []
    try:
        with open(os.path.join(FOLDER, name), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        raise Trouble(f"{name} is missing: SHA256SUMS lists it") from None
    if not rows:
        raise Trouble(f"{name} has no rows: there is nothing in it to compare or to compute from")
    ROWS_READ[name] = len(rows)
    return rows


def number(text):
    """An empty cell is a missing value."""
    return float(text) if text else NAN


class Checked:
    """Compares what was computed with what a file says."""
    all = []

    def __init__(self, name, source, rows, keys, aside=()):
        self.name, self.source, self.rows, self.aside = name, source, rows, list(aside)
        self.keys, self.skipped, self.notes = keys, [], []  # skipped: outcomes whose rows were not computed
        self.compared, self.largest, self.wrong, self.scales = 0, 0.0, [], {}
        self.open = [column for column in (rows[0] if rows else ()) if column not in keys]
        Checked.all.append(self)

    def compare(self, row, values):
        """values: what was computed, by column. Numbers are compared as such, everything else as text."""
        for column, value in values.items():
            if column not in row or column in self.keys:
                continue
            if column in self.open:
                self.open.remove(column)
            self.compared += 1
            if isinstance(value, str):
                difference = 0.0 if row[column] == value else math.inf
            else:
                difference = self.difference(row, column, number(row[column]), float(value))
            self.largest = max(self.largest, difference)
            if difference > TOLERANCE:
                self.wrong.append(f"{self.name}, {column}: the file says {row[column] or 'nothing'}, computed {value}")

    def difference(self, row, column, said, value):
        if math.isnan(said) or math.isnan(value):
            return 0.0 if math.isnan(said) and math.isnan(value) else math.inf
        if said == value:
            return 0.0
        if math.isinf(said) or math.isinf(value):
            return math.inf
        return abs(said - value) / max(abs(said), abs(value), NEAR_ZERO * self.scale_of(row, column))

    def scale_of(self, row, column):
        """What a number next to zero is held against."""
        if not is_of_mean(column):
            return self.largest_of(column)
        sizes = [abs(number(row[other])) for other in row if is_of_mean(other) and row[other]]
        return max([self.largest_of(column)] + [size for size in sizes if size < math.inf])

    def largest_of(self, column):
        if column not in self.scales:
            sizes = [abs(number(row[column])) for row in self.rows if row[column]]
            self.scales[column] = max((size for size in sizes if size < math.inf), default=0.0)
        return self.scales[column]

    def report(self):
        print(f"{self.name}: from {self.source}")
        print(f"  {self.compared} values compared, largest difference {self.largest:.1e}")
        left = [column for column in self.open if column not in self.aside]
        if left:
            print("  not computed: " + ", ".join(left))
        if self.skipped:
            print("  not computed: the rows of " + ", ".join(self.skipped))
        for line in self.notes:
            print("  " + line)
        for line in self.wrong[:5]:
            print("  DIFFERS: " + line)


def is_of_mean(column):
    """Whether it is of a mean, whose rounding is that of the values that it is taken from."""
    return any(part in column for part in ("mean", "sd", "ci95"))


def suffixed(row, begin):
    """The column of a row whose name begins so: slope_per_ is slope_per_n_per_m in one study, slope_per_s in another."""
    return next(column for column in row if column.startswith(begin))


# --- From trials to cells --------------------------------------------------------------------------------------------

def corrected_rate(k, n, correction):
    """What is done about rates of 0 and 1, whose z is infinite."""
    if correction == "loglinear":
        return (k + 0.5) / (n + 1)
    if correction == "half" and k in (0, n):
        return 0.5 / n if k == 0 else 1 - 0.5 / n
    return k / n


def mean(values):
    return sum(values) / len(values) if values else NAN


def delivered_stiffness(intervals):
    """By session and event: the stiffness delivered in each interval, a mean over its devices."""
    found = {}
    for row in intervals:
        stiffness = suffixed(row, "stiffness_") if any(c.startswith("stiffness_") for c in row) else None
        if stiffness and row[stiffness]:
            found.setdefault((row["session"], row["seq"], row["interval"]), []).append(float(row[stiffness]))
    return {key: mean(values) for key, values in found.items()}


def counted(trials):
    """Practice never counts; neither do trials that a registered rule leaves out."""
    return [row for row in trials if row["practice"] == "0" and row["excluded"] == "0"]


def grouped(rows, *columns):
    found = {}
    for row in rows:
        found.setdefault(tuple(row[column] for column in columns), []).append(row)
    return found


def by_cell(trials):
    return grouped(trials, "participant", "condition", "series")


def pairs_of_series(trials):
    """The softer and the stiffer object of each series."""
    pairs = {}
    for row in trials:
        stimuli = [float(row[column]) for column in row if column.startswith("stimulus_")]
        low, high = pairs.get(row["series"], (math.inf, -math.inf))
        pairs[row["series"]] = (min(low, *stimuli), max(high, *stimuli))
    return pairs


def said_different(row):
    return (row["same"] == "1") != (row["correct"] == "1")


def delivery(trials, pair, stiffness):
    """What the devices delivered in the trials of a cell."""
    differences, without_fit, by_object = [], 0, ([], [])
    for row in trials:
        got = []
        for interval in ("1", "2"):
            asked = float(row[suffixed(row, f"stimulus_{interval}_")])
            k = stiffness.get((row["session"], row["seq"], interval))
            got.append(k)
            if k is not None:
                by_object[1 if asked > (pair[0] + pair[1]) / 2 else 0].append(k)
        if row["same"] == "1":
            continue
        if None in got:
            without_fit += 1
        else:
            differences.append(abs(got[1] - got[0]))
    return differences, without_fit, by_object


def rates(n_diff, hits, n_same, false_alarms, correction):
    """The yes-no model: d' = z(H) - z(F), with its standard error (Gourevitch and Galanter 1967)."""
    if n_diff == 0 or n_same == 0:
        names = ("raw_hit_rate", "raw_false_alarm_rate", "hit_rate", "false_alarm_rate", "z_hit", "z_false_alarm",
                 "dprime", "dprime_se", "dprime_ci95_low", "dprime_ci95_high", "criterion")
        return {**dict.fromkeys(names, NAN), "status": "missing"}
    z_hit, z_false = z_of(hits, n_diff, correction), z_of(false_alarms, n_same, correction)
    dprime = z_hit - z_false
    variance = (z_variance(hits, n_diff, z_hit, correction) + z_variance(false_alarms, n_same, z_false, correction))
    se = math.sqrt(variance)
    one_answer = hits + false_alarms in (0, n_diff + n_same)
    wald = NORMAL.inv_cdf(0.975) * se
    return {"raw_hit_rate": hits / n_diff, "raw_false_alarm_rate": false_alarms / n_same,
            "hit_rate": corrected_rate(hits, n_diff, correction),
            "false_alarm_rate": corrected_rate(false_alarms, n_same, correction),
            "z_hit": z_hit, "z_false_alarm": z_false, "dprime": dprime, "dprime_se": se,
            "dprime_ci95_low": dprime - wald, "dprime_ci95_high": dprime + wald,
            "criterion": -(z_hit + z_false) / 2, "status": "no_information" if one_answer else "ok"}


def z_variance(k, n, z, correction):
    if math.isinf(z):
        return NAN
    share = corrected_rate(k, n, correction) * corrected_rate(n - k, n, correction)
    return share / (n * NORMAL.pdf(z) ** 2)


def cells_of(trials, intervals, said):
    """A row for each row of cells.csv. said: those; from them it takes which cells are planned and which correction
    and differences (as asked, or as delivered) were registered."""
    main = [row for row in trials if row["practice"] == "0"]
    everything, used = by_cell(main), by_cell(counted(trials))
    pairs, stiffness = pairs_of_series(main), delivered_stiffness(intervals)
    cells = []
    for row in said:
        key = (row["participant"], row["condition"], row["series"])
        rows = used.get(key, [])
        different = [one for one in rows if one["same"] == "0"]
        same = [one for one in rows if one["same"] == "1"]
        hits, false_alarms = sum(map(said_different, different)), sum(map(said_different, same))
        pair = pairs.get(row["series"], (NAN, NAN))
        differences, without_fit, (softer, stiffer) = delivery(rows, pair, stiffness)
        cell = {"participant": key[0], "condition": key[1], "series": key[2],
                suffixed(row, "difference_"): pair[1] - pair[0],
                suffixed(row, "delivered_difference_"): mean(differences), "n_delivered": len(differences),
                "n_without_fit": without_fit,
                suffixed(row, "delivered_softer_"): mean(softer), "n_softer": len(softer),
                suffixed(row, "delivered_stiffer_"): mean(stiffer), "n_stiffer": len(stiffer),
                "n_diff": len(different), "hits": hits, "n_same": len(same), "false_alarms": false_alarms,
                "excluded": len(everything.get(key, [])) - len(rows),
                **rates(len(different), hits, len(same), false_alarms, row["correction"])}
        cell["x"] = mean(differences) if row["difference_source"] == "delivered" else pair[1] - pair[0]
        cells.append(cell)
    return cells


# --- From cells to thresholds ----------------------------------------------------------------------------------------

def unit_slope(dprime):
    """d' of the independent-observation model from that of the yes-no model (Macmillan and Creelman 2005, ch. 9)."""
    if math.isnan(dprime) or math.isinf(dprime):
        return dprime
    largest = NORMAL.cdf(abs(dprime) / 2)
    return math.copysign(2 * NORMAL.inv_cdf((1 + math.sqrt(2 * largest - 1)) / 2), dprime) if dprime else 0.0


def slope_of(cells, method, model, correction):
    """The slope of d' on the difference x, through the origin; None where it is refused."""
    if not any(cell["status"] == "ok" for cell in cells):
        return NAN
    points = [(cell["x"], cell["dprime"]) for cell in cells]
    if model == "independent-observation":
        points = [(x, unit_slope(d)) for x, d in points]
    if method == "inverse_mean_slope":
        return mean([d / x for x, d in points])
    if method == "mean_of_ratios":
        if any(math.isnan(d) for x, d in points):
            return NAN
        if any(d / x <= LEAST_SLOPE for x, d in points):
            return None
        return len(points) / sum(x / d for x, d in points)
    weights = [1.0] * len(points)
    if method == "weighted":
        weights = [1 / sum(z_variance(k, n, z_of(k, n, "loglinear"), "loglinear")
                           for k, n in ((cell["hits"], cell["n_diff"]), (cell["false_alarms"], cell["n_same"])))
                   for cell in cells]
    return (sum(w * x * d for w, (x, d) in zip(weights, points)) /
            sum(w * x * x for w, (x, d) in zip(weights, points)))


def jnd_of(slope):
    """Status and JND."""
    if slope is None:
        return "no_sensitivity", NAN
    if math.isnan(slope):
        return "no_information", NAN
    if slope == math.inf:
        return "ceiling", 0.0
    return ("no_sensitivity", NAN) if slope <= LEAST_SLOPE else ("ok", 1 / slope)


def cautions(cells, missing, status, jnd):
    names = []
    if status == "ok" and not min(c["x"] for c in cells) <= jnd <= max(c["x"] for c in cells):
        names.append("extrapolated")
    if status == "ok" and all(c["hits"] == c["n_diff"] and c["false_alarms"] == 0 for c in cells):
        names.append("floor")
    if any(min(c["n_diff"], c["n_same"]) < 10 for c in cells):
        names.append("few_trials")
    return " ".join(names + (["series_missing"] if missing else []))


def thresholds_of(cells, trials, said):
    """A row for each row of thresholds.csv."""
    rows, cells_by, trials_by = [], grouped(cells, "participant", "condition"), grouped(counted(trials), "participant", "condition")
    for row in said:
        key = (row["participant"], row["condition"])
        own, times = cells_by.get(key, []), trials_by.get(key, [])
        used = [c for c in own if c["status"] != "missing"]
        slope = slope_of(used, row["method"], row["model"], row["correction"])
        status, jnd = jnd_of(slope)
        reference = float(row[suffixed(row, "reference_")])
        typed = [float(t["response_time_s"]) for t in times if t["entered_by"] == "participant"]
        rows.append({"participant": row["participant"], "condition": row["condition"], "series_used": len(used),
                     suffixed(row, "slope_per_"): NAN if slope is None else slope,
                     next(c for c in row if c.startswith("jnd_") and "ci95" not in c): jnd,
                     "weber": jnd / reference, "status": status,
                     "cautions": cautions(used, len(used) < len(own), status, jnd),
                     "median_response_time_s": median(typed) if typed else NAN,
                     "mean_trial_s": mean([float(t["duration_s"]) for t in times])})
    return rows


def thresholds_as_said(said):
    """Where the method is none of those above, the rows of thresholds.csv themselves."""
    words = ("participant", "condition", "status", "cautions")
    return [{column: row[column] if column in words else numeric(row[column]) for column in row} for row in said]


def numeric(text):
    try:
        return number(text)
    except ValueError:
        return text


# --- From participants to the group ----------------------------------------------------------------------------------

def mean_with_interval(values):
    """n, mean, standard deviation and Student's 95 % interval."""
    n, m = len(values), mean(values)
    if n < 2:
        return n, m, NAN, NAN, NAN
    sd = math.sqrt(sum((value - m) ** 2 for value in values) / (n - 1))
    half = t_quantile(n - 1) * sd / math.sqrt(n)
    return n, m, sd, m - half, m + half


def mean_columns(name, unit, values):
    n, m, sd, low, high = mean_with_interval(values)
    return {f"n_{name}": n, f"{name}_mean{unit}": m, f"{name}_sd{unit}": sd, f"{name}_ci95_low{unit}": low,
            f"{name}_ci95_high{unit}": high}


def median_of_jnds(rows, jnd):
    """No sensitivity counts as an infinite JND, the ceiling as none at all."""
    values = sorted({"ok": row[jnd], "no_sensitivity": math.inf, "ceiling": 0.0}[row["status"]] for row in rows
                    if row["status"] != "no_information")
    if not values:
        return {"n_median": 0, "median": NAN, "status": "no_information"}
    upper, lower = values[len(values) // 2], values[(len(values) - 1) // 2]
    if upper == math.inf:
        return {"n_median": len(values), "median": math.inf, "status": "no_sensitivity"}
    if lower == 0:
        return {"n_median": len(values), "median": NAN, "status": "ceiling"}
    return {"n_median": len(values), "median": median(values), "status": "ok"}


def check_jnd_group(thresholds, source):
    said = read("group.csv")
    checked = Checked("group.csv", source, said, ("condition", "kind"), CONVENTION)
    for row in said:
        rows = [one for one in thresholds if one["condition"] == row["condition"]]
        jnd, slope, unit = threshold_columns(rows[0] if rows else thresholds[0])
        ok = [one for one in rows if one["status"] == "ok"]
        slopes = [one[slope] for one in rows if math.isfinite(one[slope]) and one["status"] != "no_information"]
        middle = median_of_jnds(rows, jnd)
        values = {"participants": len(rows), **mean_columns("jnd", unit, [one[jnd] for one in ok]),
                  "n_median": middle["n_median"], f"jnd_median{unit}": middle["median"],
                  "jnd_median_status": middle["status"],
                  **mean_columns("log_jnd", "", [math.log(one[jnd]) for one in ok]),
                  "n_slope": len(slopes), "n_used": len(ok),
                  f"inverse_mean_slope{unit}": 1 / mean(slopes) if slopes and mean(slopes) > LEAST_SLOPE else NAN,
                  **mean_columns("weber", "", [one["weber"] for one in ok])}
        for status in ("no_sensitivity", "ceiling", "no_information"):
            values["n_" + status] = sum(one["status"] == status for one in rows)
        checked.compare(row, values)


def threshold_columns(row):
    """The names of JND and slope, and the unit in them."""
    slope = suffixed(row, "slope_per_")
    unit = slope[len("slope_per"):]
    return "jnd" + unit, slope, unit


def summary(values):
    """The columns of a mean of those who have a value."""
    there = [value for value in values if math.isfinite(value)]
    n, m, sd, low, high = mean_with_interval(there)
    return {"n_used": n, "mean": m, "sd": sd, "ci95_low": low, "ci95_high": high,
            "median": median(there) if there else NAN}


def check_threshold_group(tracks, source):
    """Of an adaptive procedure."""
    said = read("group.csv")
    checked = Checked("group.csv", source, said, ("condition",))
    for row in said:
        rows = [one for one in tracks if one["condition"] == row["condition"] and one["track"] == ""]
        ok = [one for one in rows if one["status"] == "ok"]
        n, m, sd, _, _ = mean_with_interval([float(one["threshold"]) for one in ok])
        shares = [int(one["false_alarms"]) / int(one["catch_trials"]) if int(one["catch_trials"]) else NAN
                  for one in ok]
        checked.compare(row, {"participants": len(rows), "n_used": n, "threshold_mean": m, "threshold_sd": sd,
                              "false_alarm_rate": mean(shares)})


def check_estimate_group(estimates, source):
    """Of the tasks that have estimates of their own."""
    said = read("group.csv")
    checked = Checked("group.csv", source, said, ("condition", "standard", "kind", "outcome", "unit"))
    checked.aside = [column for column in (said[0] if said else ()) if column.startswith("standard_")]
    for row in said:
        rows = [e for e in estimates if (e["condition"], e["standard"]) == (row["condition"], row["standard"])]
        values = [float(e[row["outcome"]]) for e in rows if e[row["outcome"]]]
        checked.compare(row, {"participants": len(rows), **summary(values)})


# --- Conditions against each other -----------------------------------------------------------------------------------

def paired_t(differences):
    """Student's t of paired differences, and its two-sided p."""
    n, m, sd, low, high = mean_with_interval(differences)
    if n < 2 or sd <= ROUNDING * max(map(abs, differences)):
        return {"t": NAN, "df": n - 1 if n > 1 else NAN, "p": NAN, "low": NAN, "high": NAN, "dz": NAN}
    t = m / (sd / math.sqrt(n))
    return {"t": t, "df": n - 1, "p": t_two_sided(t, n - 1), "low": low, "high": high, "dz": m / sd}


def same_decimal(x, y):
    return abs(x - y) <= 1e-12 * max(abs(x), abs(y))


def midranks(values):
    """Ranks from 1; equal values share the mean of theirs. Also the sum of t^3 - t over the ties."""
    order = sorted(range(len(values)), key=lambda i: values[i])
    ranks, ties, first = [0.0] * len(values), 0.0, 0
    while first < len(order):
        last = first
        while last + 1 < len(order) and same_decimal(values[order[first]], values[order[last + 1]]):
            last += 1
        for place in range(first, last + 1):
            ranks[order[place]] = (first + last) / 2 + 1
        ties += (last - first + 1) ** 3 - (last - first + 1)
        first = last + 1
    return ranks, ties


def wilcoxon(differences):
    """V of the signed-rank test and its p as R computes it: exact below 50 pairs without ties and zeros, else by the
    normal distribution with a correction for continuity."""
    used = [d for d in differences if d != 0]
    if not used:
        return 0.0, NAN
    ranks, ties = midranks([abs(d) for d in used])
    v, n = sum(rank for rank, d in zip(ranks, used) if d > 0), len(used)
    total = n * (n + 1) / 2
    if n < 50 and ties == 0 and n == len(differences):
        ways = [1] + [0] * int(total)  # how many subsets of the ranks have each sum
        for rank in range(1, n + 1):
            for place in range(len(ways) - 1, rank - 1, -1):
                ways[place] += ways[place - rank]
        return v, min(1.0, 2 * sum(ways[:int(min(v, total - v)) + 1]) / 2 ** n)
    sd = math.sqrt(n * (n + 1) * (2 * n + 1) / 24 - ties / 48)
    return v, min(1.0, 2 * NORMAL.cdf(-max(0.0, abs(v - total / 2) - 0.5) / sd))


def holm(p_values):
    """Holm's correction; what is no number stays none and is not counted."""
    order = sorted((i for i, p in enumerate(p_values) if not math.isnan(p)), key=lambda i: p_values[i])
    adjusted, largest = list(p_values), 0.0
    for place, i in enumerate(order):
        largest = max(largest, (len(order) - place) * p_values[i])
        adjusted[i] = min(1.0, largest)
    return adjusted


class Outcome:
    """Values of an outcome by participant and condition; NaN where one is missing."""

    def __init__(self, name, values):
        self.name, self.values = name, values
        self.conditions = []
        for own in values.values():
            self.conditions += [condition for condition in own if condition not in self.conditions]
        # Where groups get different conditions, nobody but those who get them all is in tests over all conditions.
        self.crossed = all(len(own) == len(self.conditions) for own in values.values())
        whole = [own for own in values.values() if len(own) == len(self.conditions)]
        self.complete = [own for own in whole if all(math.isfinite(value) for value in own.values())]
        self.left_out = len(whole) - len(self.complete)
        # A mean over those who have a value would pick the good ones; slopes exist for nearly everyone.
        self.refused = (name != "slope" and self.left_out > 0) or len(self.complete) < 2 or len(self.conditions) < 2

    def differences(self, a, b):
        return [own[a] - own[b] for own in self.complete]

    def of_both(self, a, b):
        return [(own[a], own[b]) for own in self.values.values() if a in own and b in own]


def outcome_of_thresholds(name, thresholds):
    jnd, slope, _ = threshold_columns(thresholds[0])
    values = {}
    for row in thresholds:
        if name == "slope":
            value = row[slope]
        elif name == "trial_time":
            value = row["mean_trial_s"]
        elif name not in ("jnd", "log_jnd"):
            return None
        else:
            value = row[jnd] if row["status"] == "ok" else NAN
            value = math.log(value) if name == "log_jnd" and value > 0 else value
        values.setdefault(row["participant"], {})[row["condition"]] = value
    return Outcome(name, values)


def outcome_of_tracks(name, tracks):
    values = {}
    for row in tracks:
        if row["track"] == "":
            value = number(row["threshold"]) if row["status"] == "ok" else NAN
            values.setdefault(row["participant"], {})[row["condition"]] = value
    return Outcome(name, values)


def outcome_of_estimates(name, estimates):
    """Of each participant and condition the mean over the standards, of logarithms where the name says ln_."""
    column = name[len("ln_"):] if name.startswith("ln_") and name not in estimates[0] else name
    if column not in estimates[0]:
        return None
    cells = {}
    for row in estimates:
        value = number(row[column])
        if column != name:
            value = math.log(value) if value > 0 else NAN
        cells.setdefault((row["participant"], row["condition"]), []).append(value if math.isfinite(value) else NAN)
    values = {}
    for (participant, condition), of_standards in cells.items():
        values.setdefault(participant, {})[condition] = mean(of_standards)
    return Outcome(name, values)


def outcome_of_ratings(question, answers, people):
    """Of the answers to a question that is asked for each condition: the mean within a session, then over sessions.
    people: rows of whoever counts, with the conditions that they get."""
    sessions = {}
    for row in answers:
        if row["question"] == question and row["condition"] and row["answer"]:
            key = (row["participant"], row["condition"])
            sessions.setdefault(key, {}).setdefault(row["session"], []).append(float(row["answer"]))
    if not sessions:
        return None
    values = {}
    for row in people:
        own = sessions.get((row["participant"], row["condition"]), {})
        value = mean([mean(of_session) for of_session in own.values()])
        values.setdefault(row["participant"], {})[row["condition"]] = value
    return Outcome(question, values)


def test_of(name, pairs):
    """p of one contrast, before any correction. None: this script has no such test (Games and Howell's and Tukey's need
    the studentised range)."""
    differences = [a - b for a, b in pairs]
    if name == "holm-t":
        return paired_t(differences)["p"]
    if name == "wilcoxon":
        return wilcoxon(differences)[1]
    return None


def finite_pairs(pairs):
    return [pair for pair in pairs if all(map(math.isfinite, pair))]


def p_of_contrasts(outcome, contrasts, each_alone, test):
    """The p of each contrast, corrected as registered; None where this script does not have the test."""
    p_values = []
    for a, b in contrasts:
        both = outcome.of_both(a, b)
        if each_alone:
            tested = finite_pairs(both)
            refused = (outcome.name != "slope" and len(tested) < len(both)) or len(tested) < 2
        else:
            tested, refused = [(own[a], own[b]) for own in outcome.complete], outcome.refused
        p_values.append(NAN if refused else test_of(test, tested))
    return None if None in p_values else dict(zip(contrasts, holm(p_values)))


HIERARCHICAL = "hierarchical_log_jnd"


def check_contrasts(outcome_named, source):
    said = read("contrasts.csv")
    if not said:
        return
    checked = Checked("contrasts.csv", source, said, ("condition_a", "condition_b", "kind", "outcome", "unit",
                                                      "registered", "test"), CONVENTION)
    # Those of the hierarchical model have no separate values that they could be computed from.
    computed = [row for row in said if row["outcome"] != HIERARCHICAL]
    if len(computed) < len(said):
        checked.skipped.append(HIERARCHICAL)
    scale = computed[0]["outcome"]
    on_scale = [row for row in computed if row["outcome"] == scale]
    tested = outcome_named(scale)
    # Where somebody has no value in one condition, contrasts of the others are tested all the same.
    each_alone = not tested.crossed or (tested.refused and tested.left_out > 0)
    test = max(row["test"] for row in on_scale)  # empty in rows without p
    contrasts = [(row["condition_a"], row["condition_b"]) for row in on_scale]
    p_values = p_of_contrasts(tested, contrasts, each_alone, test) if test else None
    for row in computed:
        contrast = (row["condition_a"], row["condition_b"])
        outcome = tested if row["outcome"] == scale else outcome_named(row["outcome"])
        pairs = finite_pairs(outcome.of_both(*contrast))
        if outcome is tested and not each_alone and outcome.name != "jnd":
            pairs = [(own[contrast[0]], own[contrast[1]]) for own in outcome.complete]
        n, m, sd, low, high = mean_with_interval([x - y for x, y in pairs])
        everyone = len(tested.of_both(*contrast)) if each_alone else len(tested.complete) + tested.left_out
        values = {"participants": everyone, "n_difference": n, "difference_mean": m, "difference_sd": sd,
                  "difference_ci95_low": low, "difference_ci95_high": high}
        if row["registered"] == "1" and p_values is not None:
            values["p"] = p_values[contrast]
        checked.compare(row, values)


def check_pairs(outcome_named, source):
    """Every pair of conditions."""
    said = read("pairs.csv")
    if not said:
        return
    checked = Checked("pairs.csv", source, said, ("outcome", "condition_a", "condition_b"))
    for name in dict.fromkeys(row["outcome"] for row in said):
        outcome, rows = outcome_named(name), [row for row in said if row["outcome"] == name]
        if outcome is None:
            checked.skipped.append(name)
            continue
        differences = [outcome.differences(row["condition_a"], row["condition_b"]) for row in rows]
        t = [paired_t(d) for d in differences]
        ranks = [wilcoxon(d) for d in differences]
        t_holm, ranks_holm = holm([one["p"] for one in t]), holm([p for _, p in ranks])
        for i, row in enumerate(rows):
            checked.compare(row, {"n_used": len(differences[i]), "mean_difference": mean(differences[i]),
                                  "ci95_low": t[i]["low"], "ci95_high": t[i]["high"], "t": t[i]["t"],
                                  "t_df": t[i]["df"], "t_p": t[i]["p"], "t_p_holm": t_holm[i], "dz": t[i]["dz"],
                                  "wilcoxon_v": ranks[i][0], "wilcoxon_p": ranks[i][1],
                                  "wilcoxon_p_holm": ranks_holm[i]})


def analysis_of_variance(table):
    """Of one factor within participants; table: a row a participant, a column a condition."""
    n, k = len(table), len(table[0])
    grand = mean([value for row in table for value in row])
    rows, columns = [mean(row) for row in table], [mean([row[j] for row in table]) for j in range(k)]
    between = n * sum((c - grand) ** 2 for c in columns)
    error = sum((table[i][j] - rows[i] - columns[j] + grand) ** 2 for i in range(n) for j in range(k))
    people = k * sum((r - grand) ** 2 for r in rows)
    df1, df2 = k - 1, (n - 1) * (k - 1)
    if error <= ROUNDING ** 2 * sum(value * value for row in table for value in row):
        return {}  # nothing but rounding is left, and there is no test
    f = between / df1 / (error / df2)
    # Greenhouse and Geisser's epsilon, from the double-centred covariances of the conditions.
    covariance = [[sum((table[i][a] - columns[a]) * (table[i][b] - columns[b]) for i in range(n)) / (n - 1)
                   for b in range(k)] for a in range(k)]
    means = [mean(line) for line in covariance]
    centred = [[covariance[a][b] - means[a] - means[b] + mean(means) for b in range(k)] for a in range(k)]
    trace = sum(centred[a][a] for a in range(k))
    epsilon = trace ** 2 / (df1 * sum(value ** 2 for line in centred for value in line))
    rest = df1 * (n - 1 - df1 * epsilon)
    huynh_feldt = 1.0 if k == 2 else NAN if n <= 2 else (n * df1 * epsilon - 2) / rest if rest > 0 else math.inf
    capped = huynh_feldt if math.isnan(huynh_feldt) else min(1.0, huynh_feldt)
    return {"f": f, "df1": df1, "df2": df2, "p": f_upper(f, df1, df2), "epsilon_gg": epsilon,
            "p_gg": f_upper(f, epsilon * df1, epsilon * df2), "eta2_partial": between / (between + error),
            "eta2_generalised": between / (between + error + people), "epsilon_hf": huynh_feldt,
            "p_hf": f_upper(f, capped * df1, capped * df2)}


def friedman(table):
    n, k = len(table), len(table[0])
    sums, ties = [0.0] * k, 0.0
    for row in table:
        ranks, tied = midranks(row)
        sums, ties = [total + rank for total, rank in zip(sums, ranks)], ties + tied
    spread = (n * k * (k + 1) * (k - 1) - ties) / (k - 1)
    if spread <= 0:
        return {"friedman_chi2": NAN, "friedman_p": NAN, "kendall_w": NAN}
    chi2 = 12 * sum((total - n * (k + 1) / 2) ** 2 for total in sums) / spread
    return {"friedman_chi2": chi2, "friedman_p": chi2_upper(chi2, k - 1), "kendall_w": chi2 / (n * (k - 1))}


def check_tests(outcome_named, source):
    said = read("tests.csv")
    if not said:
        return
    checked = Checked("tests.csv", source, said, ("outcome", "unit", "registered"))
    for row in said:
        outcome = outcome_named(row["outcome"])
        if outcome is None:
            checked.skipped.append(row["outcome"])
            continue
        table = [[own[condition] for condition in outcome.conditions] for own in outcome.complete]
        checked.compare(row, {"n_used": len(table), "participants": len(table) + outcome.left_out, **friedman(table),
                              **analysis_of_variance(table)})


def check_groups(outcome_named, groups, source):
    """Groups of participants: means under each condition, and of each participant's mean over all of theirs."""
    said = read("groups.csv")
    if not said:
        return
    checked = Checked("groups.csv", source, said, ("group", "condition", "kind", "outcome", "unit"))
    for row in said:
        outcome = outcome_named(row["outcome"])
        own = [values for participant, values in outcome.values.items() if groups.get(participant) == row["group"]]
        if row["condition"]:
            values = [one[row["condition"]] for one in own]
        else:
            values = [mean(list(one.values())) if all(map(math.isfinite, one.values())) else NAN for one in own]
        checked.compare(row, {"participants": len(own), **summary(values)})


# --- The hierarchical model ------------------------------------------------------------------------------------------

NOT_IN_MODEL = ("missing", "one_answer", "one_level", "perfect")  # statuses of conditions that it leaves out
EXACT, STEP, SMALL_SD = 1e-5, 0.01, 0.05  # of ln L; of a parameter; of a spread of 0
FIRST = ("first", "left")


def answers_by_level(observer, by_standard):
    """By condition and standard, then participant, then level: how many answers were positive ("different", "yes", the
    comparison), and how many were not."""
    trials, found = read("trials.csv"), {}

    def add(row, level, positive, negative):
        if positive + negative:
            people = found.setdefault((row["condition"], row["series"] if by_standard else ""), {})
            tally = people.setdefault(row["participant"], {}).setdefault(level, [0, 0])
            tally[:] = tally[0] + positive, tally[1] + negative

    if "cells.csv" in LISTED:
        for cell in cells_of(trials, read("intervals.csv"), read("cells.csv")):
            equal = -cell["x"] if observer == "independent" else 0.0  # the level of equal stimuli
            add(cell, cell["x"], cell["hits"], cell["n_diff"] - cell["hits"])
            add(cell, equal, cell["false_alarms"], cell["n_same"] - cell["false_alarms"])
        return found
    stimuli = lambda row: [float(row[column]) for column in row if column.startswith("stimulus_")]
    standard = lambda row: float(row[suffixed(row, "standard_")])
    greater = all((row["target"] in FIRST) == (stimuli(row)[0] > stimuli(row)[1])
                  for row in trials if observer == "choice" and row["target"])  # whether the greater is to be chosen
    for row in counted(trials):
        if observer == "choice":
            second = row["standard_interval"] == "1"  # the comparison
            level, positive = stimuli(row)[second] - standard(row), ((row["answer"] in FIRST) != second) == greater
        elif "same" in row:
            level, positive = abs(stimuli(row)[0] - stimuli(row)[1]), said_different(row)
        else:
            level, positive = abs(stimuli(row)[0] - standard(row)), row["answer"] == "yes"
        add(row, level, int(positive), int(not positive))
    return found


def ln_rates(observer, lapse, level, ln_s, criterion):
    """ln of the probability of a positive answer, and of the other one."""
    cdf, slope = lambda z: math.erfc(-z / math.sqrt(2)) / 2, math.exp(-ln_s)
    x = level * slope
    if observer == "differencing":
        x, t = x / math.sqrt(2), math.exp(criterion) / math.sqrt(2)
        rates = cdf(x - t) + cdf(-x - t), cdf(t - x) - cdf(-x - t)
    else:
        if observer == "independent":
            half = min(abs(x), 70) / 2
            x = math.copysign(NORMAL.inv_cdf(2 * cdf(half) * cdf(-half)), x)
        z = x - criterion * (slope if observer == "choice" else 1)
        rates = cdf(z), cdf(-z)
    return [math.log(max(lapse / 2 + (1 - lapse) * rate, 1e-300)) for rate in rates]


def marginals(people, places, rates, fineness):
    """ln L at each place: of each person the integral over u, w and, in each condition, v, where ln s = mu + u + v and
    criterion = kappa + w. By the trapezoid rule; its nodes lie as close as so many answers may need, times fineness."""
    trials = [[sum(map(sum, levels.values())) for levels in own.values()] for own in people]
    most, sd = max(map(sum, trials)), {name: places[0][name] or SMALL_SD for name in ("tu", "tv", "tw")}
    du, dv, dw = (1 / (fineness * math.sqrt(1 / sd[name] ** 2 + information)) for name, information in
                  (("tu", 0.4 * most), ("tv", 0.4 * max(map(max, trials))), ("tw", 0.64 * most)))
    step = min(du, dv)  # of ln s; a step of u is of_u of them, a step of v of_v
    of_u, of_v = int(du / step), int(dv / step)
    du, dv, totals = of_u * step, of_v * step, [0.0] * len(places)

    @functools.lru_cache(None)
    def prior(spread, d):
        far = math.ceil(6.5 * spread / d)
        return [NormalDist(0, spread).pdf(n * d) * d for n in range(-far, far + 1)] if spread else [1.0]

    widest = sum(n * (len(prior(1.1 * sd[name], n * step)) // 2) for name, n in (("tu", of_u), ("tv", of_v)))
    for own in people:
        largest = {c: sum(n * math.log(n / sum(tally)) for tally in levels.values() for n in tally if n)
                   for c, levels in own.items()}  # ln of the largest likelihood that any rates give

        @functools.lru_cache(None)
        def likelihoods(c, mu, kappa, j):
            at = lambda a, level: rates(level, mu + a * step, kappa + j * dw)
            return [math.exp(sum([n * rate for level, tally in own[c].items() for n, rate in zip(tally, at(a, level))])
                             - largest[c]) for a in range(-widest, widest + 1)]

        @functools.lru_cache(None)
        def ln_over_v(c, mu, kappa, tv, i, j):
            weights, middle = prior(tv, dv), widest + i * of_u
            far = len(weights) // 2 * of_v
            values = likelihoods(c, mu, kappa, j)[middle - far:middle + far + 1:of_v]
            return math.log(sum(map(operator.mul, weights, values)) or 1e-300)

        for number, place in enumerate(places):
            of_i, of_j = prior(place["tu"], du), prior(place["tw"], dw)
            far_i, far_j = len(of_i) // 2, len(of_j) // 2
            ln_height = lambda i, j: math.log(of_i[far_i + i] * of_j[far_j + j]) + sum(
                [ln_over_v(c, place["mu of " + c], place["kappa of " + c], place.get("tv of " + c, place["tv"]), i, j)
                 for c in own])
            # From the middle uphill, then outwards until what is left is less than e^-20 of the highest node.
            nodes, highest, seen, heap = [], -math.inf, {(0, 0)}, [(-ln_height(0, 0), 0, 0)]
            while heap and -heap[0][0] > highest - 20:
                low, i, j = heapq.heappop(heap)
                nodes, highest = nodes + [-low], max(highest, -low)
                for near in {(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)} - seen:
                    if abs(near[0]) <= far_i and abs(near[1]) <= far_j:
                        seen.add(near)
                        heapq.heappush(heap, (-ln_height(*near), *near))
            totals[number] += highest + math.log(sum(math.exp(one - highest) for one in nodes)) + sum(largest.values())
    return totals


def check_hierarchical():
    """ln L at the exported estimates; and that it is a maximum: no small step of one of them raises it."""
    said = read("hierarchical.csv")
    if not said:
        return
    checked = Checked("hierarchical.csv", "the trials, at its own estimates", said, ("condition", "standard"))
    first, used = said[0], [row for row in said if row["status"] not in NOT_IN_MODEL]
    reasons = {f"the status of {row['condition']} is {row['status']}": row["status"] != "ok" for row in used}
    reasons.update({"levels were pooled": first["levels"], "exact is 0": first["exact"] == "0",
                    "no condition is in it": not used, "trials.csv is not in this folder": "trials.csv" not in LISTED})
    if any(reasons.values()):
        checked.open = []
        checked.notes.append("not computed: the model, because " + ", ".join(filter(reasons.get, reasons)))
        return
    choice, several = first["observer"] == "choice", len({row.get("standard") for row in said}) > 1
    jnd, criterion = suffixed(first, "jnd_"), suffixed(first, "bias_" if choice else "criterion")
    checked.open = [column for column in first if "ci95" in column or column.startswith(("weber", "pse", "equal"))]
    units = [float(row[jnd]) / float(row["weber"]) if several and row["weber"] else 1.0 for row in used]  # standards
    s = [float(row[jnd]) / float(row.get("jnd_of_s", 1)) / unit for row, unit in zip(used, units)]
    scale = min(s) if choice else 1.0  # so that criteria have the unit 1
    place, steps, people, names, by_level = {}, [], {}, [], answers_by_level(first["observer"], "standard" in first)
    for row, unit, own_s in zip(used, units, s):
        where = (row["condition"], row.get("standard", ""))
        c = ", ".join(where) if where[1] else where[0]
        place["mu of " + c] = math.log(own_s / scale)
        place["kappa of " + c] = float(row[criterion] or 0) / (unit * scale if choice else 1)  # empty: taken as 0
        names.append(c)
        free = ("mu", "kappa") if row[criterion] else ("mu",)
        steps += [(f"{name} of {c}", size) for name in free for size in (-STEP, STEP)]
        for who, levels in by_level[where].items():
            people.setdefault(who, {})[c] = {level / unit / scale: tally for level, tally in levels.items()}
    spreads = [("tu", "persons", first), ("tw", "pse" if choice else "criterion", first)]
    own_tv = len({row["sd_persons_by_condition"] for row in used}) > 1
    for c, row in zip(names, used) if own_tv else [(None, first)]:
        spreads.append((f"tv of {c}" if own_tv else "tv", "persons_by_condition", row))
    for name, column, row in spreads:
        place[name] = float(row["sd_" + column] or 0) / (scale if name == "tw" else 1)
        size = min(STEP, place[name] / 10) or SMALL_SD
        sizes = {"ok": (-size, size), "zero": (size,), "at_limit": (-size,)}.get(row[f"sd_{column}_status"], ())
        steps += [(name, one) for one in sizes]
    place.setdefault("tv", max(value for name, value in place.items() if name.startswith("tv")))
    rates = functools.lru_cache(1 << 18)(functools.partial(ln_rates, first["observer"], float(first.get("lapse", 0))))
    at = lambda places, fineness: marginals(list(people.values()), places, rates, fineness)
    fineness = next((f for f in (1.0, 1.4, 2.0) if abs(at([place], f)[0] - at([place], 1.4 * f)[0]) < EXACT / 3), None)
    if fineness is None:
        checked.notes.append("not computed: the model, because its integrals depend on how finely they are summed")
        return
    ln_l, *others = at([place] + [{**place, name: place[name] + size} for name, size in steps], fineness)
    rises = [other - ln_l for other in others]
    checked.compared += 1 + len(rises)
    checked.notes.append(f"ln L is {ln_l:.5f}; {len(steps)} small steps of the estimates add {max(rises):.5f} at most "
                         f"(tolerance {EXACT})")
    if not abs(ln_l - number(first["log_likelihood"])) < EXACT:
        said_ln_l = first["log_likelihood"]
        checked.wrong.append(f"hierarchical.csv, log_likelihood: the file says {said_ln_l}, computed {ln_l}")
    for (name, size), rise in zip(steps, rises):
        if rise > EXACT:
            checked.wrong.append(f"hierarchical.csv, {name}: a step of {size:.2g} adds {rise:.5f} to ln L")


# --- All of it -------------------------------------------------------------------------------------------------------

# What every row says of the analysis: read, not computed.
CONVENTION = ("difference_source", "model", "correction", "method", "protocol_sha256", "kind", "group")
CLOSED = ("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios")


def check_same_different():
    """From the trials upwards. Returns the outcomes by name, and what they rest on."""
    trials, said_cells, said = read("trials.csv"), read("cells.csv"), read("thresholds.csv")
    cells = cells_of(trials, read("intervals.csv"), said_cells)
    checked = Checked("cells.csv", "trials.csv and intervals.csv", said_cells, ("participant", "condition", "series"),
                      CONVENTION)
    for row, cell in zip(said_cells, cells):
        checked.compare(row, cell)
    if said[0]["method"] in CLOSED:
        source = "trials.csv"
        thresholds = thresholds_of(cells, trials, said)
        checked = Checked("thresholds.csv", source, said, ("participant", "condition"), CONVENTION)
        checked.aside.append(suffixed(said[0], "reference_"))
        for row, threshold in zip(said, thresholds):
            checked.compare(row, threshold)
    else:
        source = f"the participants' JNDs in thresholds.csv (method {said[0]['method']})"
        thresholds = thresholds_as_said(said)
    check_jnd_group(thresholds, source)
    return lambda name: outcome_of_thresholds(name, thresholds), source, said


def main():
    tracks, estimates = read("tracks.csv"), read("estimates.csv")
    if "thresholds.csv" in LISTED and "trials.csv" in LISTED:
        outcome_named, source, people = check_same_different()
    elif read("thresholds.csv"):
        source = "the participants' JNDs in thresholds.csv (trials.csv is not in this folder)"
        people = read("thresholds.csv")
        thresholds = thresholds_as_said(people)
        check_jnd_group(thresholds, source)
        outcome_named = lambda name: outcome_of_thresholds(name, thresholds)
    elif tracks:
        source, people = "the participants' thresholds in tracks.csv", tracks
        check_threshold_group(tracks, source)
        outcome_named = lambda name: outcome_of_tracks(name, tracks) if name == "threshold" else None
    elif estimates:
        source, people = "the participants' estimates in estimates.csv", estimates
        check_estimate_group(estimates, source)
        outcome_named = lambda name: outcome_of_estimates(name, estimates)
    else:
        raise Trouble("there is nothing to compute: this folder has no thresholds, tracks or estimates of participants")
    groups = {row["participant"]: row.get("group", "") for row in read("participants.csv")}
    check_contrasts(outcome_named, source)
    answers = read("answers.csv")
    of_any = lambda name: outcome_named(name) or outcome_of_ratings(name, answers, people)
    with_ratings = source + ("; ratings from answers.csv" if answers else "")
    check_pairs(of_any, with_ratings)
    check_tests(of_any, with_ratings)
    check_groups(outcome_named, groups, source)
    check_hierarchical()
    for checked in Checked.all:
        checked.report()
    print("rows read: " + ", ".join(f"{read} of {ROWS.get(name)} in {name}" for name, read in ROWS_READ.items()))
    changed = [name for name, read in ROWS_READ.items() if read != ROWS.get(name)]
    if changed:
        print("  DIFFERS: the number of rows in " + ", ".join(changed))
    print("not computed here: intervals of single estimates (bootstrap or profile likelihood; methods.md says which)")
    wrong = sum(len(checked.wrong) for checked in Checked.all)
    compared = sum(checked.compared for checked in Checked.all)
    print(f"{compared} values compared, {wrong} differ by more than {TOLERANCE}")
    return 1 if wrong or changed or not compared else 0


if __name__ == "__main__":
    FOLDER = sys.argv[1] if len(sys.argv) > 1 else HERE
    try:
        LISTED, ROWS = listed()
        sys.exit(main())
    except Trouble as trouble:
        sys.exit(f"recompute.py: {trouble}")
