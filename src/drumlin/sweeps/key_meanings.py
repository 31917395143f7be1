"""What each key of a sweep file means, in words, beside what its type says."""

from drumlin.brake.key_meanings import KeyMeaningsOfPart
from drumlin.sweeps.file import Normal, Range, SweepFile, Triangular, TruncatedNormal, Uniform
from drumlin.sweeps.options import FemOptions, FoundationOptions, SolidOptions

# Keys that several distributions share, each with its meaning.
_MEANINGS_OF_KEYS_SHARED_BY_DISTRIBUTIONS = {
    "distribution": "name of the distribution",
    "each_shoe": "whether each shoe draws a value of its own",
}
_MEANINGS_OF_RANGE_END_KEYS = {"from": "lower end", "to": "upper end"}
_MEANINGS_OF_MEAN_AND_DEVIATION_KEYS = {
    "mean": "mean value, by default the value in the brake file",
    "deviation": "standard deviation, as a quantity or in % of the mean",
}

MEANINGS_OF_SWEEP_FILE_KEYS: tuple[KeyMeaningsOfPart, ...] = (
    ("The sweep", SweepFile, {
        "title": "title of the sweep, by default the title of the brake",
        "brake": "path of a brake file, or a brake as a table",
        "combine": "how lists are combined: `grid` every value with every other value; `zip` the "
            "first values of all lists, then the second values; `random` random draws",
        "cases": "number of random draws",
        "seed": "seed of the random draws",
        "pressure": "unit of stresses in the table and its headings",
        "certify": "which cases by finite elements are solved on all levels for their errors: "
            "`every case`; or a sample that also gives the other cases their errors: `every 10th`, "
            "another number, or the number of cases to draw",
        "model": "one table `[model.NAME]` for each model, with its options",
        "vary": "the table `[vary]`: keys of the brake file, such as "
            "`\"shoe[0].lining.thickness\"`, each with a list, a range or a distribution of "
            "values"}),
    ("A range", Range, {**_MEANINGS_OF_RANGE_END_KEYS, "count": "number of values",
    "scale": "equal steps (`linear`), or equal ratios (`log`)"}),
    ('`distribution = "uniform"`', Uniform, {
        **_MEANINGS_OF_KEYS_SHARED_BY_DISTRIBUTIONS, **_MEANINGS_OF_RANGE_END_KEYS}),
    ('`distribution = "triangular"`', Triangular, {
        **_MEANINGS_OF_KEYS_SHARED_BY_DISTRIBUTIONS, **_MEANINGS_OF_RANGE_END_KEYS,
        "mode": "most frequent value, by default the value in the brake file"}),
    ('`distribution = "normal"` or `"lognormal"`', Normal, {
        **_MEANINGS_OF_KEYS_SHARED_BY_DISTRIBUTIONS, **_MEANINGS_OF_MEAN_AND_DEVIATION_KEYS}),
    ('`distribution = "truncated-normal"`', TruncatedNormal, {
        **_MEANINGS_OF_KEYS_SHARED_BY_DISTRIBUTIONS, **_MEANINGS_OF_MEAN_AND_DEVIATION_KEYS,
        **_MEANINGS_OF_RANGE_END_KEYS}),
    ("`[model.fem]`", FemOptions, {
        "elements": "number of elements along each lining", "kind": "kind of the elements",
        "penalty": "contact stiffness over E/t of the lining",
        "tolerance": "largest error of p and of the torque, in place of `elements`",
        "finite_width": "whether the answer is corrected for the widths of the shoes",
        "model_error": "whether the error of plane stress itself is stated"}),
    ("`[model.solid]`", SolidOptions, {
        "across": "degree of the polynomials across the width",
        "tolerance": "largest error of p (mean over the width) and of the torque, without `across`",
        "penalty": "contact stiffness over E/t of the lining"}),
    ("`[model.foundation]`", FoundationOptions, {
        "sections": "number of sections of each beam",
        "lift": "names of the simplifications whose neglected effects are computed"}),
)  # fmt: skip
