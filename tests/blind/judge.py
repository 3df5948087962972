"""Judges dynid's diagnosis on recordings that nothing of dynid has made.

    python tests/blind/judge.py --dynid target/release/dynid --seeds 40 --first-seed 1 --kinds null,single,pair

Needs `pip install -r tests/blind/requirements.txt`. Draws a case for each seed (two of five without an effect where no
kinds are given), runs `dynid diagnose`, and compares what it names with what was hidden. The same seed gives the same
bytes. Verdicts:

    right      everything hidden is named on its joints (or equivalently), and nothing else
    told       some of it only among what the motion cannot tell apart, or as small; nothing else
    missed     some of it is not told, nothing false is
    remainder  right, and besides a free form over a variable of the law hidden on the joint: its shape is not exact
    misnamed   another law, on a joint on which something hidden shows
    false      a law on a joint on which nothing shows, or of the whole robot (contact, delay, ...) that was not hidden
    refused    no diagnosis
"""

import argparse
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # sums in one order: the same bytes on every machine

import cases  # noqa: E402

VERDICTS = ["right", "told", "remainder", "missed", "misnamed", "false", "refused"]
SEEN = 0.7  # units of the noise: an effect shows on a joint from here on
# What describes the same physics as well as the effect's own name: (id, why). Joints must agree.
EQUIVALENT = {
    "payload": [("added_mass", "a body on the last link is the same body")],
    "drive_efficiency": [("load_dependent_friction", "equal losses either way are friction in proportion to the load")],
    "spring": [("position_dependent_torque", "a spring is a torque over the position")],
    "position_dependent_torque": [("spring", "within a short travel the curve is straight, or a lever's")],
    "product_of_positions": [("free_form", "no law of the catalogue")],
    "friction_of_another_angle": [("free_form", "no law of the catalogue")],
    "swirl": [("free_form", "no law of the catalogue")],
    "heating": [
        ("friction_drift", "a temperature that rises with the motion"),
        ("friction_level_change", "beside a baseline the warm joint has less friction"),
        ("free_form", "no law of the catalogue"),
    ],
    "friction_after_rest": [("free_form", "no law of the catalogue")],
}
# Catalogue laws over these variables of the own joint are special cases of a free form over them.
VARIABLES = {
    "stribeck": ("dq",),
    "nonlinear_viscous": ("dq",),
    "asymmetric_friction": ("dq",),
    "position_dependent_friction": ("q", "dq"),
    "presliding_hysteresis": ("dq", "q"),
    "torque_ripple": ("q",),
    "spring": ("q",),
    "position_dependent_torque": ("q",),
    "load_dependent_friction": ("load", "dq"),
    "drive_efficiency": ("load", "dq"),
    "torque_saturation": ("load", "tau"),
}
WHOLE = ("base_tilt", "time_delay", "wrong_sample_rate")  # of the whole robot: no joint is asked for


def on_its_joints(effect, joints):
    """Whether joints that were told are those of a hidden effect: all of one of two joints need not be told."""
    hidden = set(effect["joints"])
    if effect["effect"] in WHOLE or not joints or not hidden:
        return True
    if effect["effect"] == "contact":
        return bool(hidden & set(joints))
    if effect["effect"] == "torque_crosstalk":
        return effect["joints"][-1] in joints
    if effect["effect"] in cases.devices.OUTSIDE:
        return list(joints) == [effect["joints"][-1]]
    return hidden == set(joints)


def names(effect):
    return [effect["effect"]] + [i for i, _ in EQUIVALENT.get(effect["effect"], [])]


def among(effect, told):
    """Whether one of the laws that cannot be told apart is the effect on its joints."""
    on = told.get("on") or [told["joints"]] * len(told["between"])
    return any(law in names(effect) and on_its_joints(effect, joints) for law, joints in zip(told["between"], on))


def is_special_case(effect, finding):
    """A free form on the joint over variables of the law that is hidden there."""
    if effect["effect"] == "coupled_transmission" and finding["effect"] == "free_form":
        # Joints that are no neighbours: the catalogue has no such transmission.
        i, j = effect["joints"]
        speeds = {f"{v}{k}" for v in ("dq", "ddq") for k in (i, j)}
        return j - i > 1 and finding["joints"][0] in (i, j) and set(finding.get("variables", [])) <= speeds
    if finding["effect"] != "free_form" or finding["joints"] != [effect["joints"][-1] if effect["joints"] else 0]:
        return False
    own = {f"{v}{finding['joints'][0]}" for v in VARIABLES.get(effect["effect"], ())}
    if effect["effect"] == "torque_crosstalk":
        own = {f"torque{effect['joints'][0]}"}
    return bool(own) and set(finding.get("variables", [])) <= own


def judge(truth, found):
    """Verdict and notes: what is missing, what is told besides."""
    findings, besides, notes = found["findings"], [], []
    hidden = [e for e in truth["effects"]]
    credited, told, remainder = set(), set(), False
    for f in findings:
        mine = [k for k, e in enumerate(hidden) if f["effect"] in names(e) and on_its_joints(e, f["joints"])]
        if not mine:
            besides.append(f)
        credited |= set(mine)
    for k, e in enumerate(hidden):
        if k in credited:
            continue
        sets = [c for c in found["cannot_tell"] if among(e, c)]
        small = [s for s in found["small"] if s["effect"] in names(e) and on_its_joints(e, s["joints"])]
        if sets or small:
            told.add(k)
            notes.append(f"{label(e)} as {'one of ' + '/'.join(sets[0]['between']) if sets else 'small'}")
            besides = [f for f in besides if not any(f["effect"] in c["between"] for c in sets)]
    for f in list(besides):
        for k, e in enumerate(hidden):
            if is_special_case(e, f):
                besides.remove(f)
                if k in credited | told:
                    remainder = True
                    notes.append(f"remainder {label(f)}")
                else:
                    credited.add(k)
                    notes.append(f"{label(e)} as {label(f)}")
                break
    if truth["sensors"]["low_pass"]:  # a filter of the whole torque channel is a delay to first order
        besides = [f for f in besides if f["effect"] != "time_delay"]
    missing = [e for k, e in enumerate(hidden) if k not in credited | told]
    seen = {j for e in hidden for j, x in enumerate(e["visible_by_joint"], 1) if x > SEEN or j in e["joints"]}
    false = [f for f in besides if not f["joints"] or not seen & set(f["joints"])]
    if besides:
        notes.append("besides: " + " ".join(label(f) for f in besides))
    if missing:
        notes.append("missing: " + " ".join(f"{label(e)} ({e['visible']:.1f})" for e in missing))
    if false:
        return "false", notes
    if besides:
        return "misnamed", notes
    if missing:
        return "missed", notes
    return ("remainder" if remainder else "told" if told else "right"), notes


def label(x):
    over = "(" + ",".join(x["variables"]) + ")" if x.get("variables") else ""
    return f"{x['effect']}{over}@{'+'.join(map(str, x['joints'])) or 'all'}"


def diagnose(dynid, folder, baseline):
    """Runs dynid on the recording of a folder; the seconds that it took."""
    Path(f"{folder}.json").unlink(missing_ok=True)
    call = [dynid, "diagnose", f"{folder}/recording.yaml", "--json", f"{folder}.json", "--threads", "1"]
    if baseline:
        call += ["--baseline", f"{folder}/baseline.yaml"]
    start = time.time()
    done = subprocess.run(call, capture_output=True, text=True)
    Path(f"{folder}.log").write_text(" ".join(call) + "\n" + done.stdout + done.stderr)
    return time.time() - start


def result(folder):
    """What a diagnosis left in the folder, or why there is none."""
    if Path(f"{folder}.json").exists():
        return json.loads(Path(f"{folder}.json").read_text()), ""
    told = Path(f"{folder}.log").read_text().split("\n", 1)[1].replace(f"{Path(folder).parent}/", "")
    return None, " ".join(told.split())[:160]


@dataclass
class Judged:
    """A case with what became of it."""

    kind: str
    name: str
    truth: dict
    verdict: str
    notes: str
    seconds: float

    def line(self, timed=True):
        hidden = " ".join(f"{label(e)} ({e['visible']:.1f})" for e in self.truth["effects"]) or "nothing"
        where = f"{self.truth['robot']} {self.truth['sensors']['rate']} Hz {self.truth['sensors']['noise']}"
        where += " baseline" if self.truth["baseline"] else ""
        took = f"{self.seconds:4.1f} s " if timed else ""
        return f"{self.name:18} {self.verdict:9} {took} {where}  {hidden}  {self.notes}"


def case(dynid, root, kind, seed, baseline, again=False):
    """Draws, diagnoses and judges the case of a seed; where `again`, judges what is in the folder.

    Raises cases.NotVisible where the effect of the seed does not show, FileNotFoundError where nothing is to be judged again.
    """
    folder = Path(root) / f"{kind}-{seed}{'-b' if baseline else ''}"
    if not again:
        cases.write(cases.draw(seed, kind, baseline), folder, seed)
    truth = json.loads(Path(f"{folder}.truth.json").read_text())
    seconds = 0.0 if again else diagnose(dynid, folder, truth["baseline"])
    found, why = result(folder)
    verdict, notes = judge(truth, found) if found else ("refused", [why])
    return Judged(kind, folder.name, truth, verdict, "; ".join(notes), seconds)


def table(title, counts):
    """Verdicts counted by what is in the first column."""
    lines = [f"| {title} | " + " | ".join(VERDICTS) + " |", "|" + "---|" * (len(VERDICTS) + 1)]
    lines += [f"| {key} | " + " | ".join(str(count[v] or "") for v in VERDICTS) + " |" for key, count in counts.items()]
    return "\n".join(lines)


def arguments(description):
    """What every run needs to know: which dynid, from which seed on."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dynid", default="target/release/dynid")
    parser.add_argument("--first-seed", type=int, default=1)
    return parser


def main():
    parser = arguments(__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--kinds", help="null, single, pair, outside or names of effects, with commas; in turn by seed")
    parser.add_argument("--baseline", action="store_true", help="with a recording from before")
    parser.add_argument("--rescore", action="store_true", help="judge again what is in the folder of --keep")
    parser.add_argument("--keep", help="folder for the cases; a temporary one where it is not given")
    a = parser.parse_args()
    kinds = a.kinds.split(",") if a.kinds else ["null", "single", "null", "single", "single"]
    root = Path(a.keep or tempfile.mkdtemp(prefix="dynid-blind-"))
    root.mkdir(parents=True, exist_ok=True)
    by_kind, by_effect = {}, {}
    for seed in range(a.first_seed, a.first_seed + a.seeds):
        kind = kinds[seed % len(kinds)]
        try:
            judged = case(a.dynid, root, kind, seed, a.baseline, a.rescore)
        except (cases.NotVisible, FileNotFoundError) as failure:
            print(f"{kind}-{seed} not drawn: {failure}", flush=True)
            continue
        by_kind.setdefault(kind, Counter())[judged.verdict] += 1
        for e in judged.truth["effects"]:
            by_effect.setdefault(e["effect"], Counter())[judged.verdict] += 1
        print(judged.line(), flush=True)
    for title, counts in (("kind", by_kind), ("effect", by_effect)):
        print("\n" + table(title, dict(sorted(counts.items()))))
    if not a.keep:
        shutil.rmtree(root)


if __name__ == "__main__":
    main()
