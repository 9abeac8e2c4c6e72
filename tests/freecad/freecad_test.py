"""Run by freecad_test.sh within freecadcmd, which does not tell exit codes: the last line says that all was done."""

import os
import sys

import FreeCAD as App
import Part

source = os.environ["MORTISE_SOURCE"]
sys.path.insert(0, os.path.join(source, "client", "freecad"))
from mortise_freecad import bodies, check  # noqa: E402

failures = 0


def expect(good, what):
    global failures
    failures += not good
    print("\nok" if good else "\nFAILED", what, flush=True)


def fails(call):
    try:
        call()
    except check.CheckError as error:
        return str(error)
    return ""


document = App.newDocument("assembly")
Part.insert(os.path.join(source, "scenarios", "tensioner.step"), document.Name)
all_bodies = bodies.bodies_of(document)
expect(len(all_bodies) == 19, f"19 bodies of the file: {len(all_bodies)}")
report = check.run(all_bodies)
expect(report.counts["unexplained_real"] == 1 and report.counts["explained_real"] == 7, f"as of the file itself: {report.counts}")
worst = report.found[0]
expect(worst.collision_class == "real" and not worst.explained, "the worst comes first")
expect(abs(worst.depth_mm[0] - 0.4) < 1e-6, f"0.4 mm deep: {worst.depth_mm}")
reach = [thing.Shape.BoundBox for thing in (worst.a, worst.b)]
for box in reach:
    box.enlarge(1e-3)
expect(all(box.isInside(worst.point) for box in reach), f"the place {worst.point} lies in the boxes of both parts")
expect(worst.way_mm.Length > 0.39, "a way out is told")

# The selection alone; a part that was moved is checked where it stands.
pair = bodies.bodies_of(document, [worst.a, worst.b])
expect(check.run(pair).counts["unexplained_real"] == 1, "the selection alone clashes as well")
moved = worst.a.Placement.Base
worst.a.Placement.Base = moved + App.Vector(0, 0, 50)
expect(check.run(bodies.bodies_of(document, [worst.a, worst.b])).counts["unexplained_real"] == 0, "moved away: no clash")
group = document.addObject("App::Part", "Group")
group.addObject(worst.a)
group.Placement.Base = App.Vector(0, 0, -50)
expect(check.run(bodies.bodies_of(document, [group, worst.b])).counts["unexplained_real"] == 1, "moved back by its group: a clash")

# An operand of a Boolean is no body of its own.
box = document.addObject("Part::Box", "Box")
hole = document.addObject("Part::Cylinder", "Hole")
cut = document.addObject("Part::Cut", "Cut")
cut.Base, cut.Tool = box, hole
document.recompute()
names = [thing.Name for thing, _ in bodies.bodies_of(document)]
expect("Cut" in names and "Box" not in names and "Hole" not in names, "operands are left out")

document.addObject("Part::Sphere", bodies.MARK)
document.recompute()
expect(bodies.MARK not in [thing.Name for thing, _ in bodies.bodies_of(document)], "the mark of a place is left out")

expect("two solids" in fails(lambda: check.run([])), "nothing to check is said")
os.environ["MORTISE_BIN"] = "/nowhere"
expect("mortise-check is not there" in fails(lambda: check.run(pair)), "a missing program is said")
os.environ["MORTISE_BIN"] = os.environ["HOME"]
session, file = check.open_session(pair)
session.wait()
with open(os.path.join(os.path.dirname(file), "started.txt"), encoding="utf-8") as started:
    expect(started.read().split() == ["open", file], "a session is opened on the file")
expect(os.path.getsize(file) > 1000, "which is there")
print("\nALL DONE" if failures == 0 else f"{failures} FAILED", flush=True)
os._exit(failures)
