"""Writes docs/blind.md: what dynid names in recordings that nothing of dynid has made, kind by kind.

    python tests/blind/page.py --dynid target/release/dynid --first-seed 1 --out docs/blind.md

Cases and verdicts are those of judge.py, `--jobs` of them at a time.
"""

import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cases
import judge

# What is hidden: title, kind of judge.py, beside a recording from before, cases.
GROUPS = [
    ("one effect", "single", False, 54),
    ("one effect, beside a recording from before", "single", True, 54),
    ("two effects", "pair", False, 24),
    ("physics that no law of the catalogue has", "outside", False, 20),
    ("nothing", "null", False, 40),
    ("nothing, beside a recording from before", "null", True, 40),
]
TEXT = """# Blind test

Recordings that share no line of code with dynid: Pinocchio moves seven robots that are not in `robots/` (pick and place, single
strokes, slow moves, random motions; files that differ much), sensors add noise that is white, coloured, quantised, filtered,
grows with the load or wanders, currents stand for torques, and in a part of them a law stands from the beginning. One of 27
effects of the catalogue, two of them, physics that no catalogue has, or nothing at all is hidden, drawn by the seed, mostly at 2.5
or 6 times the noise on the joint that shows it most. `dynid diagnose` is not told.

```
pip install -r tests/blind/requirements.txt
python tests/blind/page.py --dynid target/release/dynid --first-seed {first} --out docs/blind.md
```

Right: everything hidden is named on its joints, or in other words for the same physics, and nothing else. Told: some of it only
among what the motion cannot tell apart, or as small. Remainder: right, with a curve besides over a variable of the same law.
Missed: nothing false, and something not told. Misnamed: another law on a joint on which what is hidden shows. False: a law
where nothing shows.

{table}

## What was not right

In brackets how many times the noise an effect is, where it shows most.

```
{wrong}
```
"""


def main():
    parser = judge.arguments(__doc__)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", default="docs/blind.md")
    a = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="dynid-blind-") as root:

        def judged(of):
            title, kind, baseline, seed = of
            try:
                one = judge.case(a.dynid, root, kind, seed, baseline)
            except cases.NotVisible as failure:
                return title, f"{kind}-{seed} not drawn: {failure}"
            print(one.line(), file=sys.stderr, flush=True)
            return title, one

        every = [
            (title, kind, baseline, a.first_seed + k)
            for title, kind, baseline, count in GROUPS
            for k in range(count)
        ]
        with ThreadPoolExecutor(a.jobs) as pool:
            results = list(pool.map(judged, every))
    counts = {title: Counter() for title, *_ in GROUPS}
    wrong = []
    for title, one in results:
        if isinstance(one, str):
            wrong.append(one)
            continue
        counts[title][one.verdict] += 1
        if one.verdict not in ("right", "remainder"):
            # How long it took depends on the machine.
            wrong.append(one.line(timed=False))
    page = TEXT.format(first=a.first_seed, table=judge.table("hidden", counts), wrong="\n".join(wrong))
    Path(a.out).write_text(page)


if __name__ == "__main__":
    main()
