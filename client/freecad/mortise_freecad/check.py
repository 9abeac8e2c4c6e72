"""Runs mortise check on bodies of a document. Needs no screen."""

import json
import os
import shutil
import subprocess
import tempfile

import FreeCAD as App

from . import bodies as _bodies


class CheckError(Exception):
    """One line that says what to do."""


def folder_of_programs():
    """Where the programs are: MORTISE_BIN, the preference Mod/mortise/Folder, or empty for PATH."""
    return os.environ.get("MORTISE_BIN") or App.ParamGet("User parameter:BaseApp/Preferences/Mod/mortise").GetString("Folder", "")


def program(name):
    folder = folder_of_programs()
    found = shutil.which(name, path=folder) if folder else shutil.which(name)
    if found is None:
        raise CheckError(f"{name} is not there; install mortise-tools and mortise-step, or set MORTISE_BIN to their folder")
    return found


class Found:
    """One pair of bodies: the bodies, class, relation, depth (lo, hi) mm, the place, and what would free it."""

    def __init__(self, pair, names, bodies):
        self.a, self.b = (bodies[name] for name in names)
        self.collision_class = "contact" if pair["contact"] else pair["class"]
        self.relation = pair["relation"]
        self.explained = pair["explained"]
        worst = pair["verdicts"][0] if pair["verdicts"] else None
        self.depth_mm = tuple(worst["delta_mm"]) if worst else None
        self.point = App.Vector(*worst["point_mm"]) if worst else None
        self.why = pair["reason"] or (worst["explanation"] if worst else "")
        self.way_mm = App.Vector(*worst["separation"]["translation_mm"]) if worst else None

    def depth_text(self):
        if self.depth_mm is None:
            return ""
        low, high = self.depth_mm
        if low <= 0:
            return "apart"
        return f"{low:.4f} mm" if high is not None and high <= 2 * low else f"at least {low:.4f} mm"


class Report:
    def __init__(self, document, bodies):
        self.json = document
        self.counts = document["counts"]
        self.not_judged = document["not_judged"]
        self.found = [Found(pair, names, bodies) for pair in document["pairs"] for names in pair["instances"]]


def run(bodies, options=()):
    """Checks bodies as bodies_of() gives them. Raises CheckError."""
    if len(bodies) < 2:
        raise CheckError("two solids are needed; open an assembly, or select parts of it")
    named = {body.name: body for body in bodies}
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "assembly.step")
        _bodies.export_step(bodies, file)
        done = subprocess.run([program("mortise-check"), file, "--json", *options], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 6):
        lines = done.stderr.strip().splitlines()
        raise CheckError(lines[-1] if lines else f"mortise-check ended with {done.returncode}")
    report = json.loads(done.stdout)
    unknown = {name for pair in report["pairs"] for names in pair["instances"] for name in names} - set(named)
    if unknown:
        raise CheckError("the file names bodies that the document does not have: " + ", ".join(sorted(unknown)))
    return Report(report, named)


def open_session(bodies, folder=None):
    """Starts a shared session on the bodies: the process of `mortise open`, and the file that it reads."""
    command = program("mortise")
    folder = folder or tempfile.mkdtemp(prefix="mortise-")
    file = os.path.join(folder, "assembly.step")
    _bodies.export_step(bodies, file)
    return subprocess.Popen([command, "open", file], cwd=folder), file
