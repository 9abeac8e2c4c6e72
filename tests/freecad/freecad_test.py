"""Run by freecad_test.sh within freecadcmd, which does not tell exit codes: the last line says that all was done."""

import os
import sys

import FreeCAD as App
import Import
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


TENSIONER = os.path.join(source, "scenarios", "tensioner.step")

# Groups, then links: FreeCAD reads an assembly either way. Names and answers are those of the file.
reports = []
for options in ({"useLinkGroup": False}, {"merge": False}):
    document = App.newDocument("assembly")
    Import.insert(TENSIONER, document.Name, **options)
    all_bodies = bodies.bodies_of(document)
    expect(len(all_bodies) == 19, f"19 bodies of the file, {options}: {len(all_bodies)}")
    labels = [body.label for body in all_bodies]
    expect({"base", "cover", "bracket"} <= set(labels) and sum("wheel" in label for label in labels) == 3, f"names of the file: {labels}")
    reports.append(check.run(all_bodies))
    expect(len({body.name for body in all_bodies}) == 19, "each name stands for one body")
    worst = reports[-1].found[0]
    expect({worst.a.label, worst.b.label} == {"cover", "bracket"}, f"the worst pair by its names: {worst.a.label}, {worst.b.label}")
    wheel = document.getObjectsByLabel("wheel")[0]
    expect(sum(body.thing.Name == wheel.Name for body in bodies.bodies_of(document, [wheel])) >= 1, "a part below groups and links is found")
    App.closeDocument(document.Name)
expect(reports[0].counts == reports[1].counts, f"links say what groups say: {reports[0].counts} {reports[1].counts}")

document = App.newDocument("merged")
whole = document.addObject("Part::Feature", "whole")
whole.Shape = Part.read(TENSIONER)
all_bodies = bodies.bodies_of(document)
expect(len(all_bodies) == 19 and all_bodies[0].label == "whole 1", f"the solids of one object: {[body.label for body in all_bodies]}")
expect(check.run(all_bodies).counts == reports[0].counts, "are judged as objects of their own")
App.closeDocument(document.Name)

document = App.newDocument("assembly")
Part.insert(TENSIONER, document.Name)
all_bodies = bodies.bodies_of(document)
expect(len(all_bodies) == 19, f"19 bodies of the file: {len(all_bodies)}")
report = check.run(all_bodies)
expect(report.counts["unexplained_real"] == 1 and report.counts["explained_real"] == 7, f"as of the file itself: {report.counts}")
worst = report.found[0]
expect(worst.collision_class == "real" and not worst.explained, "the worst comes first")
expect(abs(worst.depth_mm[0] - 0.4) < 1e-6, f"0.4 mm deep: {worst.depth_mm}")
reach = [body.shape.BoundBox for body in (worst.a, worst.b)]
for box in reach:
    box.enlarge(1e-3)
expect(all(box.isInside(worst.point) for box in reach), f"the place {worst.point} lies in the boxes of both parts")
expect(worst.way_mm.Length > 0.39, "a way out is told")

# The selection alone; a part that was moved is checked where it stands.
a, b = worst.a.thing, worst.b.thing
pair = bodies.bodies_of(document, [a, b])
expect(check.run(pair).counts["unexplained_real"] == 1, "the selection alone clashes as well")
a.Placement.Base += App.Vector(0, 0, 50)
expect(check.run(bodies.bodies_of(document, [a, b])).counts["unexplained_real"] == 0, "moved away: no clash")
group = document.addObject("App::Part", "Group")
group.addObject(a)
group.Placement.Base = App.Vector(0, 0, -50)
expect(check.run(bodies.bodies_of(document, [group, b])).counts["unexplained_real"] == 1, "moved back by its group: a clash")

# An operand of a Boolean is no body of its own.
box = document.addObject("Part::Box", "Box")
hole = document.addObject("Part::Cylinder", "Hole")
cut = document.addObject("Part::Cut", "Cut")
cut.Base, cut.Tool = box, hole
document.recompute()
names = [body.thing.Name for body in bodies.bodies_of(document)]
expect("Cut" in names and "Box" not in names and "Hole" not in names, "operands are left out")

document.addObject("Part::Sphere", bodies.MARK)
document.recompute()
expect(bodies.MARK not in [body.thing.Name for body in bodies.bodies_of(document)], "the mark of a place is left out")

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
