#!/usr/bin/env python3
"""Computes the results of a study again, from the CSV files of the folder that this script lies in.

    python3 recompute.py            (or: python3 recompute.py FOLDER)

It needs Python 3.8 or later and nothing else. It is meant to be read: each step from the answers to the group is a
short function. dictionary.csv says what every column of every file means.

    trials.csv, intervals.csv -> cells.csv       how often "different" was said, rates, z, d'
    cells, trials             -> estimates.csv   slope of d' on the difference, JND = 1 / slope; times of every task
    levels of reversals       -> tracks.csv      thresholds of staircases; sums over the tracks of a condition
    estimates                 -> group.csv       means, intervals, medians over participants
                                 values.csv      what is compared (ratings: from answers.csv), and from it
                                 conditions.csv, contrasts.csv, pairs.csv, tests.csv, groups.csv

Each step works on what the step before it computed, not on the file. Estimates of the tasks other than same-different
with given levels, and those of maximum likelihood, are taken from estimates.csv as they are, and everything from there
on is computed again.

What it prints: for each file how many numbers and words were compared and the largest relative difference; which
numbers it does not compute (x_*: all whose names begin so); how many rows it read of how many that were written; the
files that it does not compute. It ends with status 1 where a row is missing, or a number differs by more than 1e-9 of
itself; a number next to zero, such as a difference of equal means, may differ by 1e-14 of the largest number of its
column, and a mean by 1e-14 of its spread.

Of the hierarchical model (hierarchical.csv) it computes ln L at the estimates, from the trials and by nodes of its own,
and compares it within 1e-5. The estimates themselves are not searched; instead a small step of any of them, up or down,
must not raise ln L. Variants with lapses, drift, overdispersion or sureness, intervals and tests are not computed.
"""
import os
import sys

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path = [place for place in sys.path if os.path.realpath(place) != HERE]  # nothing that lies here is imported

import csv
import functools
import heapq
import itertools
import math
import operator
import re
from collections import Counter
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
    if math.isnan(df1) or math.isinf(f):
        return 0.0 if math.isinf(f) else NAN
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


@functools.lru_cache(None)
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


@functools.lru_cache(None)
def numbers_in(name):
    """The columns of a file that are numbers, by the dictionary."""
    return [row["column"] for row in read("dictionary.csv")
            if row["file"] == name and row["type"] in ("number", "integer") and row["column"] not in GIVEN]


# Columns that are no results: of the design, or what others published.
GIVEN = ("standard_value", "reference", "published", "published_half_width", "track")
KEYS = ("participant", "condition", "series")  # of cells; they are not compared


def number(text):
    """An empty cell is a missing value."""
    return float(text) if text else NAN


class Checked:
    """Compares what was computed with what a file says."""
    all = []

    def __init__(self, name, source, rows):
        self.name, self.source, self.rows = name, source, rows
        self.skipped, self.notes = [], []  # skipped: outcomes whose rows were not computed
        self.compared, self.largest, self.wrong, self.scales = 0, 0.0, [], {}
        self.open = [column for column in numbers_in(name) if any(row[column] for row in rows)]  # not computed
        Checked.all.append(self)

    def compare(self, row, values):
        """values: what was computed, by column. Numbers are compared as such, everything else as text."""
        for column, value in values.items():
            if column not in row or column in KEYS:
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
        """What a number next to zero is held against; the rounding of a mean is that of what it is taken from."""
        if column not in self.scales:
            self.scales[column] = largest(one[column] for one in self.rows)
        of_mean = re.compile("(^|_)(mean|sd|ci)(_|$)").search
        means = [row[one] for one in numbers_in(self.name) if of_mean(one)] if of_mean(column) else []
        return max(self.scales[column], largest(means))

    def report(self):
        print(f"{self.name}: from {self.source}")
        print(f"  {self.compared} values compared, largest difference {self.largest:.1e}")
        if self.open:
            print("  not computed: " + ", ".join(self.folded()))
        if self.skipped:
            print("  not computed: the rows of " + ", ".join(self.skipped))
        for line in self.notes:
            print("  " + line)
        for line in self.wrong[:5]:
            print("  DIFFERS: " + line)

    def folded(self):
        """The columns that are not computed; those of one beginning, none of which is, as one."""
        done = [column for column in numbers_in(self.name) if column not in self.open]
        for begin, columns in itertools.groupby(self.open, lambda column: column.split("_")[0]):
            columns = list(columns)
            whole = len(columns) > 1 and not any(column.startswith(begin + "_") for column in done)
            yield from [begin + ("*" if begin in columns else "_*")] if whole else columns


def check(block, source, computed, outcome_of=None):
    """computed(row): what a row of BLOCK.csv should say, by column; computed(row, outcome) if rows are about outcomes,
    each found by outcome_of(name, standard): None if this script cannot compute it."""
    rows = read(block + ".csv")
    checked = Checked(block + ".csv", source, rows) if rows else None
    for row in rows:
        outcome = [outcome_of(row["outcome"], row["standard"])] if outcome_of else []
        if None not in outcome:
            checked.compare(row, computed(row, *outcome))
        elif row["outcome"] not in checked.skipped:
            checked.skipped.append(row["outcome"])
    return checked


def largest(texts):
    return max((size for size in (abs(number(text)) for text in texts) if size < math.inf), default=0.0)


def suffixed(row, begin):
    """The column of a row whose name begins so: standard_ is standard_n_per_m in one study, standard_s in another."""
    return next((column for column in row if column.startswith(begin)), None)


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
        stiffness = suffixed(row, "stiffness_")
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


def stimuli(row):
    """What was asked for in each interval of a trial."""
    return [float(row[column]) for column in row if column.startswith("stimulus_")]


def pairs_of_series(trials):
    """The softer and the stiffer object of each series."""
    pairs = {}
    for row in trials:
        low, high = pairs.get(row["series"], (math.inf, -math.inf))
        pairs[row["series"]] = (min(low, *stimuli(row)), max(high, *stimuli(row)))
    return pairs


def said_different(row):
    return (row["same"] == "1") != (row["correct"] == "1")


def delivery(trials, pair, stiffness):
    """What the devices delivered in the trials of a cell."""
    differences, without_fit, by_object = [], 0, ([], [])
    for row in trials:
        got = []
        for interval, asked in zip(("1", "2"), stimuli(row)):
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
                 "dprime", "se", "ci_low", "ci_high", "criterion", "ln_beta")
        return {**dict.fromkeys(names, NAN), "status": "missing"}
    z_hit, z_false = z_of(hits, n_diff, correction), z_of(false_alarms, n_same, correction)
    dprime, criterion = z_hit - z_false, -(z_hit + z_false) / 2
    se = math.sqrt(z_variance(hits, n_diff, z_hit, correction) +
                   z_variance(false_alarms, n_same, z_false, correction))
    one_answer = hits + false_alarms in (0, n_diff + n_same)
    wald = NORMAL.inv_cdf(0.975) * se
    return {"raw_hit_rate": hits / n_diff, "raw_false_alarm_rate": false_alarms / n_same,
            "hit_rate": corrected_rate(hits, n_diff, correction),
            "false_alarm_rate": corrected_rate(false_alarms, n_same, correction),
            "z_hit": z_hit, "z_false_alarm": z_false, "dprime": dprime, "se": se, "ci_low": dprime - wald,
            "ci_high": dprime + wald, "criterion": criterion, "ln_beta": dprime * criterion,
            "status": "no_information" if one_answer else "ok"}


def z_variance(k, n, z, correction):
    if math.isinf(z):
        return NAN
    share = corrected_rate(k, n, correction) * corrected_rate(n - k, n, correction)
    return share / (n * NORMAL.pdf(z) ** 2)


@functools.lru_cache(None)
def cells():
    """A row for each row of cells.csv. From it comes which cells are planned, and which correction and differences (as
    asked, or as delivered) were registered. The others have x, the difference that the slope is on."""
    main = [row for row in read("trials.csv") if row["practice"] == "0"]
    everything, used = (grouped(rows, "participant", "condition", "series") for rows in (main, counted(main)))
    pairs, stiffness = pairs_of_series(main), delivered_stiffness(read("intervals.csv"))
    found = []
    for row in read("cells.csv"):
        key = (row["participant"], row["condition"], row["series"])
        rows = used.get(key, [])
        different = [one for one in rows if one["same"] == "0"]
        same = [one for one in rows if one["same"] == "1"]
        hits, false_alarms = sum(map(said_different, different)), sum(map(said_different, same))
        pair = pairs.get(row["series"], (NAN, NAN))
        differences, without_fit, (softer, stiffer) = delivery(rows, pair, stiffness)
        delivered = row["difference_source"] == "delivered"
        found.append({"participant": key[0], "condition": key[1], "series": key[2], "difference": pair[1] - pair[0],
                      "delivered_difference": mean(differences), "n_delivered": len(differences),
                      "n_without_fit": without_fit, "delivered_softer": mean(softer), "n_softer": len(softer),
                      "delivered_stiffer": mean(stiffer), "n_stiffer": len(stiffer), "n_diff": len(different),
                      "hits": hits, "n_same": len(same), "false_alarms": false_alarms,
                      "excluded": len(everything.get(key, [])) - len(rows),
                      **rates(len(different), hits, len(same), false_alarms, row["correction"]),
                      "x": mean(differences) if delivered else pair[1] - pair[0]})
    return found


# --- Tracks of a procedure -------------------------------------------------------------------------------------------

def of_track(row):
    """Of a staircase the mean and standard deviation of its last reversals; of others there is nothing to compute."""
    if not row["track"]:
        return tracks_together()[row["participant"], row["condition"], row["standard"]]
    if "sd" not in row:
        return {}
    last = [float(level) for level in row["reversals"].split()]
    last = last[len(last) - int(row["n"]):]
    return {"threshold": mean(last), "sd": spread(last)}


@functools.lru_cache(None)
def tracks_together():
    """By participant, condition and standard: all of the tracks together. The threshold is the mean of theirs, of QUEST
    by logarithms; a posterior of all answers is no mean, and not computed."""
    found = {}
    for key, (*tracks, row) in grouped(read("tracks.csv"), "participant", "condition", "standard").items():
        values = {column: sum(int(track[column]) for track in tracks)
                  for column in ("trials", "hits", "catch_trials", "false_alarms")}
        values["finished"] = all(track["finished"] == "1" for track in tracks)
        used = [track for track in tracks if track["status"] == "ok"]
        short = [track for track in tracks if track["status"] == "too_few_reversals" and track["n"] != "0"]
        if sum(int(track["n"]) for track in used + short) == int(row["n"] or 0):
            used += short  # the protocol lets them count
        if "sd" in row:
            freedom = [int(track["n"]) - 1 for track in used]
            squares = sum(of_track(track)["sd"] ** 2 * n for track, n in zip(used, freedom))
            values["threshold"] = mean([of_track(track)["threshold"] for track in used])
            values["sd"] = math.sqrt(squares / sum(freedom)) if used else NAN
        elif "sd_log10" in row:
            squares = sum(float(track["sd_log10"]) ** 2 for track in used)
            values["threshold"] = 10 ** mean([math.log10(float(track["threshold"])) for track in used])
            values["sd_log10"] = math.sqrt(squares) / len(used) if used else NAN
        found[key] = values
    return found


# --- From cells and trials to estimates ------------------------------------------------------------------------------

CLOSED = ("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios")


def unit_slope(dprime):
    """d' of the independent-observation model from that of the yes-no model (Macmillan and Creelman 2005, ch. 9)."""
    if math.isnan(dprime) or math.isinf(dprime):
        return dprime
    largest = NORMAL.cdf(abs(dprime) / 2)
    return math.copysign(2 * NORMAL.inv_cdf((1 + math.sqrt(2 * largest - 1)) / 2), dprime) if dprime else 0.0


def slope_of(cells, method, model):
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


def cautions(cells, missing, status, jnd):
    names = []
    if status == "ok" and not min(c["x"] for c in cells) <= jnd <= max(c["x"] for c in cells):
        names.append("extrapolated")
    if status == "ok" and all(c["hits"] == c["n_diff"] and c["false_alarms"] == 0 for c in cells):
        names.append("floor")
    if any(min(c["n_diff"], c["n_same"]) < 10 for c in cells):
        names.append("few_trials")
    return " ".join(names + (["series_missing"] if missing else []))


def of_cells(row, own):
    """Slope and JND of a participant and condition. own: their cells."""
    used = [cell for cell in own if cell["status"] != "missing"]
    slope = slope_of(used, row["method"], row["model"])
    status = ("no_sensitivity" if slope is None or slope <= LEAST_SLOPE else "no_information" if math.isnan(slope) else
              "ceiling" if slope == math.inf else "ok")
    jnd = 1 / slope if status == "ok" else NAN
    return {"series_used": len(used), "slope": NAN if slope is None else slope, "jnd": jnd,
            "weber": jnd / float(row["reference"]), "status": status,
            "cautions": cautions(used, len(used) < len(own), status, jnd)}


def of_tracks(row):
    """The threshold of all tracks together; of answers with a posterior of their own there is none."""
    tracks = tracks_together().get((row["participant"], row["condition"], row["standard"]), {})
    if "threshold" not in tracks:
        return {}
    threshold = tracks["threshold"]
    if "track_threshold" in row:
        return {"track_threshold": threshold}
    return {"threshold": threshold, "weber": threshold / float(row["standard_value"])}


def of_trials(main):
    """Trials and times of a participant and condition at a standard."""
    used = counted(main)
    typed = [float(one["response_time_s"]) for one in used if one["entered_by"] == "participant"]
    return {"trials": len(used), "excluded": len(main) - len(used), "median_response_time_s": median_of(typed),
            "mean_trial_s": mean([float(one["duration_s"]) for one in used])}


def check_estimates():
    """Returns the rows of estimates.csv, as computed here where they are, and what they rest on."""
    said, trials = read("estimates.csv"), read("trials.csv")
    if not said:
        raise Trouble("there is nothing to compute: this folder has no estimates of participants")
    pairs, computed = bool(trials) and said[0].get("method") in CLOSED, []
    several = len({row["standard"] for row in said}) > 1  # else one stands for all series
    main = grouped([row for row in trials if row["practice"] == "0"], "participant", "condition", *["series"] * several)
    of_people = grouped(cells(), "participant", "condition") if pairs else {}
    for row in said:
        person = (row["participant"], row["condition"])
        own = main.get((*person, row["standard"]) if several else person, [])
        computed.append({**(of_trials(own) if trials else {}),
                         **(of_cells(row, of_people[person]) if pairs else of_tracks(row))})
    of_rows = iter(computed)
    there = " and ".join(filter(read, ("trials.csv", "tracks.csv")))
    check("estimates", there or "nothing that is in this folder", lambda row: next(of_rows))
    numbers = numbers_in("estimates.csv")
    estimates = [{**row, **{column: number(row[column]) for column in numbers}, **values}
                 for row, values in zip(said, computed)]
    return estimates, "trials.csv" if pairs else "the participants' estimates in estimates.csv"


# --- From participants to the group ----------------------------------------------------------------------------------

def mean_with_interval(values):
    """n, mean, standard deviation and Student's 95 % interval."""
    n, m = len(values), mean(values)
    if n < 2:
        return n, m, NAN, NAN, NAN
    sd = math.sqrt(sum((value - m) ** 2 for value in values) / (n - 1))
    half = t_quantile(n - 1) * sd / math.sqrt(n)
    return n, m, sd, m - half, m + half


def mean_columns(values, mean_name="mean"):
    return dict(zip(("n", mean_name, "sd", "ci_low", "ci_high"), mean_with_interval(values)))


SHARES = ("correct", "area", "r2")  # outcomes whose intervals end at 0 and 1


def within_limits(outcome, found):
    """The intervals of a share end at 0 and 1."""
    if outcome in SHARES:
        for name in ("ci_low", "ci_high", "ci_within_low", "ci_within_high"):
            if not math.isnan(found.get(name, NAN)):
                found[name] = min(max(found[name], 0.0), 1.0)
    return found


def spread(values):
    return mean_with_interval(values)[2]


def median_of(values):
    return median(values) if values else NAN


def finite(values):
    return [value for value in values if math.isfinite(value)]


class Outcome:
    """Values of an outcome by participant and condition; NaN where one is missing."""

    def __init__(self, name, values):
        self.name, self.values = name, values
        self.conditions = list(dict.fromkeys(row["condition"] for row in read("group.csv")))
        # Where groups get different conditions, nobody but those who get them all is in tests over all conditions.
        whole = [own for own in values.values() if len(own) == len(self.conditions)]
        self.crossed = len(whole) == len(values)
        # A row for each participant who has a value under every condition.
        self.complete = [[own[condition] for condition in self.conditions] for own in whole
                         if all(map(math.isfinite, own.values()))]
        self.left_out = len(whole) - len(self.complete)
        self.too_few = len(self.complete) < 2 or len(self.conditions) < 2
        # A mean over those who have a value would pick the good ones; slopes exist for nearly everyone.
        self.refused = (name != "slope" and self.left_out > 0) or self.too_few

    def column(self, condition):
        place = self.conditions.index(condition)
        return [row[place] for row in self.complete]

    def differences(self, a, b):
        return [x - y for x, y in zip(self.column(a), self.column(b))]

    def of_both(self, a, b):
        return [(own[a], own[b]) for own in self.values.values() if a in own and b in own]

    def within(self, condition):
        """The interval without differences between participants (Cousineau 2005, Morey 2008)."""
        if self.too_few:
            return {"n_within": 0, "ci_within_low": NAN, "ci_within_high": NAN}
        n, k, values = len(self.complete), len(self.conditions), self.column(condition)
        centred = [value - mean(row) for value, row in zip(values, self.complete)]
        half = t_quantile(n - 1) * spread(centred) * math.sqrt(k / (k - 1) / n)
        return {"n_within": n, "ci_within_low": mean(values) - half, "ci_within_high": mean(values) + half}


def outcome_by_person(name, estimates, value):
    """value: of the rows of a participant and condition."""
    values = {}
    for (participant, condition), rows in grouped(estimates, "participant", "condition").items():
        values.setdefault(participant, {})[condition] = value(rows)
    return Outcome(name, values)


def median_with_limits(values):
    """Of two in the middle that are not both values the one that is none decides."""
    values = sorted(values)
    upper, lower = (values[len(values) // 2], values[(len(values) - 1) // 2]) if values else (NAN, NAN)
    return math.inf if upper == math.inf else NAN if lower == -math.inf else median_of(values)


def reason_without(row, name):
    """Why an outcome has no finite value."""
    if row["status"] != "ok":
        return row["status"]
    return row.get(name + "_status") or ("infinite" if math.isinf(row[name]) else "undefined")


def check_group(estimates, source):
    # No sensitivity counts as an infinite JND, the ceiling as none at all.
    limits = {"no_sensitivity": math.inf, "ceiling": -math.inf} if "method" in estimates[0] else {}
    tracks, at_standard = tracks_together(), grouped(estimates, "standard")

    @functools.lru_cache(None)
    def outcome_at(standard, name):
        return outcome_by_person(name, at_standard[standard,], lambda rows: rows[0][name])

    def computed(row):
        name = row["outcome"]
        rows = [one for one in at_standard[row["standard"],] if one["condition"] == row["condition"]]
        there = [one for one in rows if math.isfinite(one[name])]
        values = [one[name] for one in there]
        without = [reason_without(one, name) for one in rows if not math.isfinite(one[name])]
        limited = values + [limits[status] for status in without if status in limits and name != "slope"]
        found = {"participants": len(rows), **mean_columns(values), "median": median_with_limits(limited),
                 "n_median": len(limited), **outcome_at(row["standard"], name).within(row["condition"]),
                 "without": ", ".join(f"{n} {status}" for status, n in sorted(Counter(without).items()))}
        if row["geometric_mean"]:
            _, *of_logarithms = mean_with_interval([math.log(value) if value else -math.inf for value in values])
            names = ("geometric_mean", "geometric_sd", "geometric_ci_low", "geometric_ci_high")
            found.update(zip(names, map(math.exp, of_logarithms)))
        if name == "slope":
            found["inverse_mean"] = 1 / mean(values) if mean(values) > LEAST_SLOPE else NAN
        if tracks:
            own = [tracks[one["participant"], one["condition"], one["standard"]] for one in there]
            found["false_alarm_rate"] = mean([one["false_alarms"] / (one["catch_trials"] or NAN) for one in own])
        return within_limits(name, found)

    check("group", source, computed)


# --- Conditions against each other -----------------------------------------------------------------------------------

def paired_t(differences):
    """Student's t of paired differences, with its two-sided p and interval."""
    n, m, sd, low, high = mean_with_interval(differences)
    if n < 2 or sd <= ROUNDING * max(map(abs, differences)):
        return {"t_t": NAN, "t_df": n - 1 if n > 1 else NAN, "t_p": NAN, "t_ci_low": NAN, "t_ci_high": NAN, "t_dz": NAN}
    t = m / (sd / math.sqrt(n))
    return {"t_t": t, "t_df": n - 1, "t_p": t_two_sided(t, n - 1), "t_ci_low": low, "t_ci_high": high, "t_dz": m / sd}


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


def permutation_p(ranks, v):
    """Twice the smaller tail of the sum of those ranks that are positive by chance, both with v; of at most 200."""
    if len(ranks) > 200:
        return NAN
    ranks, v = [int(2 * rank) for rank in ranks], int(2 * v)  # midranks are halves
    total = sum(ranks)
    ways = [1] + [0] * total  # how many subsets of the ranks have each sum
    for rank in ranks:
        for place in range(total, rank - 1, -1):
            ways[place] += ways[place - rank]
    return min(1.0, 2 * sum(ways[:min(v, total - v) + 1]) / 2 ** len(ranks))


def wilcoxon(differences):
    """The signed-rank test; p as R computes it: exact below 50 pairs without ties and zeros, else by the normal
    distribution with a correction for continuity."""
    used = [d for d in differences if d != 0]
    if not used:
        return {"wilcoxon_v": 0.0, **dict.fromkeys(("wilcoxon_p", "wilcoxon_p_exact_permutation",
                                                    "wilcoxon_rank_biserial"), NAN)}
    ranks, ties = midranks([abs(d) for d in used])
    v, n = sum(rank for rank, d in zip(ranks, used) if d > 0), len(used)
    total = n * (n + 1) / 2
    p = exact = permutation_p(ranks, v)
    if n >= 50 or ties or n < len(differences):
        sd = math.sqrt(n * (n + 1) * (2 * n + 1) / 24 - ties / 48)
        p = min(1.0, 2 * NORMAL.cdf(-max(0.0, abs(v - total / 2) - 0.5) / sd))
    return {"wilcoxon_v": v, "wilcoxon_p": p, "wilcoxon_p_exact_permutation": exact,
            "wilcoxon_rank_biserial": (2 * v - total) / total}


def corrected(p_values):
    """With Holm's correction, Benjamini and Hochberg's, and Bonferroni's. What is no number is not counted."""
    order = sorted((i for i, p in enumerate(p_values) if not math.isnan(p)), key=lambda i: p_values[i])
    found, largest, smallest = {name: list(p_values) for name in ("holm", "bh", "bonferroni")}, 0.0, 1.0
    for place, i in enumerate(order):
        largest = max(largest, (len(order) - place) * p_values[i])
        found["holm"][i], found["bonferroni"][i] = min(1.0, largest), min(1.0, len(order) * p_values[i])
    for place, i in reversed(list(enumerate(order, 1))):
        found["bh"][i] = smallest = min(smallest, len(order) / place * p_values[i])
    return found


def outcome_named(name, standard, estimates):
    """None: neither an estimate nor a question that is asked for each condition. Of estimates, that at the standard, or
    the mean over all of them, of logarithms where the name says ln_; of ratings, the mean within a session, then over
    sessions."""
    estimates = [row for row in estimates if standard in ("all", row["standard"])]
    column = name[len("ln_"):] if name.startswith("ln_") and name not in estimates[0] else name
    rated = [row for row in read("answers.csv") if row["question"] == name and row["condition"] and row["answer"]]
    ratings = grouped(rated, "participant", "condition")

    def time(rows):
        timed = [row for row in rows if row["trials"]]
        return sum(row["trials"] * row["mean_trial_s"] for row in timed) / (sum(row["trials"] for row in timed) or NAN)

    def estimate(rows):
        values = [row[column] if math.isfinite(row[column]) else NAN for row in rows]
        return mean(values if column == name else [math.log(value) if value > 0 else NAN for value in values])

    def rating(rows):
        sessions = grouped(ratings.get((rows[0]["participant"], rows[0]["condition"]), []), "session").values()
        return mean([mean([float(row["answer"]) for row in session]) for session in sessions])

    value = time if name == "trial_time" else estimate if column in estimates[0] else rating if ratings else None
    return value and outcome_by_person(name, estimates, value)


def p_of_contrasts(outcome, contrasts, each_alone, test):
    """The p of each contrast, corrected as registered; none if this script does not have the test (those of Games and
    Howell, and of Tukey, need the studentised range)."""
    tests = {"holm-t": lambda differences: paired_t(differences)["t_p"],
             "wilcoxon": lambda differences: wilcoxon(differences)["wilcoxon_p"]}
    if test not in tests:
        return {}
    p_values = []
    for a, b in contrasts:
        both = outcome.of_both(a, b)
        differences = finite([x - y for x, y in both]) if each_alone else outcome.differences(a, b)
        lacking = (outcome.name != "slope" and len(differences) < len(both)) or len(differences) < 2
        p_values.append(NAN if (lacking if each_alone else outcome.refused) else tests[test](differences))
    return dict(zip(contrasts, corrected(p_values)["holm"]))


HIERARCHICAL = "hierarchical_ln_jnd"


def check_contrasts(outcome_of, source):
    said = read("contrasts.csv")
    separate = [row for row in said if row["outcome"] != HIERARCHICAL]
    if not separate:
        return
    of_model = [row for row in said if row["outcome"] == HIERARCHICAL]
    scale = separate[0]["outcome"]
    on_scale = [row for row in separate if row["outcome"] == scale]
    tested, contrast_of = outcome_of(scale, separate[0]["standard"]), lambda row: (row["a"], row["b"])
    # Where somebody has no value in one condition, contrasts of the others are tested all the same.
    each_alone = not tested.crossed or (tested.refused and tested.left_out > 0)
    test = max(row["test"] for row in on_scale)  # empty in rows without p
    p_values = p_of_contrasts(tested, list(map(contrast_of, on_scale)), each_alone, test)
    if of_model:
        p_values = corrected([number(row["p"]) for row in of_model])["holm"]
        p_values = dict(zip(map(contrast_of, of_model), p_values))

    def computed(row):
        a, b = contrast_of(row)
        registered = {"p_registered": p_values[a, b]} if row["registered"] == "1" and p_values else {}
        if row in of_model:
            return {"mean_difference": math.log(model_ratio(a, b)), **registered}
        both = outcome_of(row["outcome"], row["standard"]).of_both(a, b)
        differences, participants = finite([x - y for x, y in both]), len(both)
        if row["outcome"] == scale and not each_alone:
            differences, participants = tested.differences(a, b), len(tested.complete) + tested.left_out
        return {"participants": participants, **mean_columns(differences, "mean_difference"),
                "p": paired_t(differences)["t_p"], **registered}

    check("contrasts", source, computed)


def of_condition(row, outcome):
    own = [values[row["condition"]] for values in outcome.values.values() if row["condition"] in values]
    within = outcome.within(row["condition"])
    return within_limits(outcome.name, {"participants": len(own), **mean_columns(finite(own)),
                                        "median": median_of(finite(own)), **within})


def of_participant(row, outcome):
    own = outcome.values[row["participant"]]
    return {"value": own[row["condition"]], "tested": all(map(math.isfinite, own.values()))}


def of_group(row, outcome):
    """Of a group of participants under a condition, or of each participant's mean over all of theirs."""
    members = {one["participant"] for one in read("estimates.csv") if one["group"] == row["group"]}
    own = [values for who, values in outcome.values.items() if who in members]
    values = finite([one[row["condition"]] if row["condition"] else mean(list(one.values())) for one in own])
    found = {"participants": len(own), **mean_columns(values), "median": median_of(values)}
    return within_limits(outcome.name, found)


@functools.lru_cache(None)
def pairs_of(outcome):
    """Every pair of conditions."""
    found = {}
    for row in read("pairs.csv"):
        if row["outcome"] == outcome.name:
            a, b, differences = row["a"], row["b"], outcome.differences(row["a"], row["b"])
            t, sd = paired_t(differences), math.hypot(*[spread(outcome.column(one)) for one in (a, b)]) / math.sqrt(2)
            found[a, b] = {"n": len(differences), "mean_difference": mean(differences), **t, **wilcoxon(differences),
                           "t_d_av": NAN if math.isnan(t["t_t"]) else mean(differences) / sd}
    for test in ("t_p", "wilcoxon_p"):
        for name, p_values in corrected([one[test] for one in found.values()]).items():
            for one, p in zip(found.values(), p_values):
                one[f"{test}_{name}"] = p
    return found


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
    p = lambda epsilon: f_upper(f, epsilon * df1, epsilon * df2)
    return {"anova_f": f, "anova_df1": df1, "anova_df2": df2, "anova_p": p(1), "anova_p_gg": p(epsilon),
            "anova_p_hf": p(capped), "anova_p_lower_bound": p(1 / df1), "anova_ss": between, "anova_ss_error": error,
            "anova_ss_subjects": people, "epsilons_gg": epsilon, "epsilons_hf": huynh_feldt,
            "effect_eta2_generalised": between / (between + error + people),
            "effect_eta2_partial": between / (between + error),
            "effect_omega2_partial": df1 * (f - 1) / (df1 * (f - 1) + n * k),
            "effect_cohen_f": math.sqrt(between / error)}


def friedman(table):
    n, k = len(table), len(table[0])
    sums, ties = [0.0] * k, 0.0
    for row in table:
        ranks, tied = midranks(row)
        sums, ties = [total + rank for total, rank in zip(sums, ranks)], ties + tied
    spread_of_ranks = (n * k * (k + 1) * (k - 1) - ties) / (k - 1)
    if spread_of_ranks <= 0:
        return dict.fromkeys(("friedman_chi2", "friedman_p", "friedman_kendall_w", "friedman_f_iman_davenport",
                              "friedman_p_iman_davenport"), NAN)
    chi2 = 12 * sum((total - n * (k + 1) / 2) ** 2 for total in sums) / spread_of_ranks
    rest = n * (k - 1) - chi2
    f = (n - 1) * chi2 / rest if rest > 1e-12 * n * k else math.inf
    return {"friedman_chi2": chi2, "friedman_df": k - 1, "friedman_p": chi2_upper(chi2, k - 1),
            "friedman_kendall_w": chi2 / (n * (k - 1)), "friedman_f_iman_davenport": f,
            "friedman_p_iman_davenport": f_upper(f, k - 1, (k - 1) * (n - 1))}


def of_tests(row, outcome):
    table = outcome.complete
    refused = outcome.refused if row["registered"] == "1" else outcome.too_few
    return {"n": len(table), "participants": len(table) + outcome.left_out, "left_out": outcome.left_out,
            **({} if refused else {**analysis_of_variance(table), **friedman(table)})}


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
        for cell in cells():
            equal = -cell["x"] if observer == "independent" else 0.0  # the level of equal stimuli
            add(cell, cell["x"], cell["hits"], cell["n_diff"] - cell["hits"])
            add(cell, equal, cell["false_alarms"], cell["n_same"] - cell["false_alarms"])
        return found
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


def model_ratio(a, b, standard=None):
    """JND of a / JND of b, at a standard or the first; NaN where one has none."""
    jnds = [next(number(row["jnd"]) for row in read("hierarchical.csv")
                 if row["condition"] == condition and standard in (None, row["standard"])) for condition in (a, b)]
    return jnds[0] / jnds[1] if all(0 < jnd < math.inf for jnd in jnds) else NAN


def of_estimates(row):
    """What follows from JND and bias."""
    standard, found = number(row["standard_value"]), {}
    if row["weber"]:
        found["weber"] = float(row["jnd"]) / standard
    if row.get("pse"):
        found["pse"] = standard + float(row["bias"])
    return found


def check_hierarchical():
    """ln L at the exported estimates; and that it is a maximum: no small step of one of them raises it."""
    said = read("hierarchical.csv")
    checked = check("hierarchical", "the trials, at its own estimates", of_estimates)
    check("hierarchical_ratios", "hierarchical.csv",
          lambda row: {"ratio": model_ratio(row["a"], row["b"], row["standard"])})
    if not said:
        return
    first, used = said[0], [row for row in said if row["status"] not in NOT_IN_MODEL]
    reasons = {f"the status of {row['condition']} is {row['status']}": row["status"] != "ok" for row in used}
    reasons.update({"levels were pooled": first["levels_found"], "exact is 0": first["exact"] == "0",
                    "no condition is in it": not used, "trials.csv is not in this folder": "trials.csv" not in LISTED})
    if any(reasons.values()):
        checked.notes.append("not computed: the model, because " + ", ".join(filter(reasons.get, reasons)))
        return
    choice, several = first["observer"] == "choice", len({row["standard"] for row in said}) > 1
    criterion, of_criterion = ("bias", "pse") if choice else ("model_criterion", "criterion")
    shares = several and all(number(row["standard_value"]) > 0 for row in said)  # levels are shares of the standard
    units = [float(row["standard_value"]) if shares else 1.0 for row in used]
    s = [float(row["jnd"]) / float(row.get("jnd_of_s", 1)) / unit for row, unit in zip(used, units)]
    scale = min(s) if choice else 1.0  # so that criteria have the unit 1
    place, steps, people, names, by_level = {}, [], {}, [], answers_by_level(first["observer"], several)
    for row, unit, own_s in zip(used, units, s):
        where = (row["condition"], row["standard"])
        c = ", ".join(where) if several else where[0]
        place["mu of " + c] = math.log(own_s / scale)
        place["kappa of " + c] = float(row[criterion] or 0) / (unit * scale if choice else 1)  # empty: taken as 0
        names.append(c)
        free = ("mu", "kappa") if row[criterion] else ("mu",)
        steps += [(f"{name} of {c}", size) for name in free for size in (-STEP, STEP)]
        for who, levels in by_level[where[0], where[1] if several else ""].items():
            people.setdefault(who, {})[c] = {level / unit / scale: tally for level, tally in levels.items()}
    spreads = [("tu", "persons", first), ("tw", of_criterion, first)]
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
    for row, c in zip(used, names):
        checked.compare(row, {"participants": len(people), "n": sum(c in own for own in people.values())})
    checked.compared += 1 + len(rises)
    at_all = ("jnd", "log_likelihood", criterion, "sd_persons", "sd_persons_by_condition", "sd_" + of_criterion)
    checked.open = [column for column in checked.open if column not in at_all]
    checked.notes.append(f"ln L is {ln_l:.5f}; {len(steps)} small steps of the estimates add {max(rises):.5f} at most "
                         f"(tolerance {EXACT})")
    if not abs(ln_l - number(first["log_likelihood"])) < EXACT:
        said_ln_l = first["log_likelihood"]
        checked.wrong.append(f"hierarchical.csv, log_likelihood: the file says {said_ln_l}, computed {ln_l}")
    for (name, size), rise in zip(steps, rises):
        if rise > EXACT:
            checked.wrong.append(f"hierarchical.csv, {name}: a step of {size:.2g} adds {rise:.5f} to ln L")

# --- All of it -------------------------------------------------------------------------------------------------------

# Files that are no results.
RECORDS = ("participants.csv", "sessions.csv", "trials.csv", "intervals.csv", "voided.csv", "answers.csv", "log.csv",
           "dictionary.csv")


def main():
    if read("trials.csv"):
        of_rows = iter(cells())
        check("cells", "trials.csv and intervals.csv", lambda row: next(of_rows))
    check("tracks", "the levels of its reversals", of_track)
    estimates, source = check_estimates()
    check_group(estimates, source)
    outcome_of = functools.lru_cache(None)(lambda name, standard: outcome_named(name, standard, estimates))
    check_contrasts(outcome_of, source)
    with_ratings = source + ("; ratings from answers.csv" if read("answers.csv") else "")
    for block, computed in {"values": of_participant, "conditions": of_condition, "tests": of_tests, "groups": of_group,
                            "pairs": lambda row, outcome: pairs_of(outcome)[row["a"], row["b"]]}.items():
        check(block, with_ratings, computed, outcome_of)
    check_hierarchical()
    for checked in Checked.all:
        checked.report()
    print("rows read: " + ", ".join(f"{read} of {ROWS.get(name)} in {name}" for name, read in ROWS_READ.items()))
    changed = [name for name, read in ROWS_READ.items() if read != ROWS.get(name)]
    if changed:
        print("  DIFFERS: the number of rows in " + ", ".join(changed))
    left = sorted(name for name in ROWS if "/" not in name and name not in ROWS_READ and name not in RECORDS)
    if left:
        print("files not computed: " + ", ".join(left))
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
