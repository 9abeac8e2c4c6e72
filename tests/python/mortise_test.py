"""The package mortise: the same answers as the programs, numpy in and out, errors, threads, a live session."""

import json
import os
import pathlib
import subprocess
import threading
import time

import numpy as np
import pytest

import mortise

BIN = pathlib.Path(os.environ["MORTISE_BIN"])
SOURCE = pathlib.Path(os.environ["MORTISE_SOURCE"])
TENSIONER = SOURCE / "scenarios" / "tensioner.step"
LOG = SOURCE / "tests" / "golden" / "thin_wall.mcap"
needs_step = pytest.mark.skipif(not (BIN / "mortise-import-step").exists(), reason="program absent: OpenCASCADE")

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
SIDES = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6],
                  [1, 3, 5], [3, 7, 5]])


def cube(size=10.0, name="cube"):
    return mortise.Part(size * CORNERS, SIDES, name)


def plate():
    return mortise.Part.generate("plate_with_bore", name="plate", bore_mm=20, facets=32)


def peg():
    return mortise.Part.generate("dowel", name="peg", diameter_mm=20, length_mm=40, chamfer_mm=1, facets=32, phase_rad=np.pi / 32)


def test_a_mesh_comes_back():
    part = cube()
    assert part.points.shape == (8, 3) and part.points.dtype == np.float64
    assert part.triangles.shape == (12, 3) and part.triangles.dtype == np.uint32
    again = mortise.Part(part.points, part.triangles, "again")
    assert again.hash == part.hash and again.volume_mm3 == pytest.approx(1000)
    assert part.has_inside and part.notes == [] and len(part.features) == 6


def test_arrays_of_any_kind_are_taken():
    lists = mortise.Part([[float(x) for x in row] for row in 10 * CORNERS], SIDES.tolist())
    columns = mortise.Part(np.asfortranarray(10 * CORNERS), np.asfortranarray(SIDES.astype(np.uint16)))
    assert lists.hash == columns.hash == cube().hash


@pytest.mark.parametrize("points, triangles", [
    (CORNERS[:, :2], SIDES), (CORNERS, SIDES[:, :2]), (CORNERS, SIDES + 1), (CORNERS, SIDES - 1), (CORNERS * np.nan, SIDES),
    (CORNERS[:0], SIDES[:0]), (CORNERS, np.zeros((1, 3), int))])
def test_what_is_no_mesh_raises(points, triangles):
    with pytest.raises(mortise.Error) as raised:
        mortise.Part(points, triangles)
    assert raised.value.code == "invalid_input" and str(raised.value)


@pytest.mark.parametrize("fit, wanted", [("H7/g6", "fake"), ("H7/k6", "potential"), ("H7/p6", "real")])
def test_judge_classes(fit, wanted):
    judgement = mortise.judge(plate(), peg(), fit=fit, X_WB=[0, 0, -10])
    worst = judgement.clashes[0]
    assert judgement.worst == wanted == worst.collision_class
    assert worst.depth_mm[0] <= 0.0483 and worst.depth_mm[1] >= 0.0481
    assert worst.fake_up_to_mm < worst.real_above_mm
    assert (worst.witness is not None) == (wanted == "real")
    assert worst.point.shape == (3,) and fit in worst.explanation
    assert wanted in judgement._repr_html_()


def test_a_judged_pair_has_the_bits_of_the_program(tmp_path):
    for part in (plate(), peg()):
        part.save(str(tmp_path / f"{part.name}.stl"))
    said = subprocess.run([BIN / "mortise-judge", "plate.stl", "peg.stl", "--fit", "H7/p6", "--json"], cwd=tmp_path, text=True,
                          capture_output=True, check=True).stdout
    ours = mortise.judge(tmp_path / "plate.stl", tmp_path / "peg.stl", fit="H7/p6")
    assert ours.json()["pairs"] == json.loads(said)["pairs"]
    first = json.loads(said)["pairs"][0]["verdicts"][0]
    assert tuple(first["delta_mm"]) == ours.clashes[0].depth_mm  # the same bits, not nearly
    assert first["point_mm"] == list(ours.clashes[0].point)


def test_anything_with_vertices_and_faces_is_a_part():
    class Trimesh:
        vertices, faces = 10 * CORNERS, SIDES

    assert mortise.distance(Trimesh(), (10 * CORNERS, SIDES), X_WB=[13, 0, 0]).distance_mm == pytest.approx(3)


class Vector:  # of CadQuery
    def __init__(self, point):
        self.point = point

    def toTuple(self):
        return tuple(self.point)


class Shape:
    def __init__(self, vector):
        self.vector, self.asked = vector, None

    def tessellate(self, tolerance, angularTolerance=0.1):
        self.asked = tolerance
        return [self.vector(point) for point in 10 * CORNERS], [tuple(side) for side in SIDES.tolist()]


class Workplane:
    def __init__(self, *shapes):
        self.shapes = list(shapes)

    def vals(self):
        return self.shapes


def test_shapes_of_scripts_are_parts():
    for shape in (Shape(Vector), Shape(tuple)):  # build123d: points that are sequences
        assert mortise.distance(shape, Workplane(Shape(Vector)), X_WB=[13, 0, 0]).distance_mm == pytest.approx(3)
        assert shape.asked == 0.01
    for stack in ((), (Shape(Vector), Shape(Vector))):
        with pytest.raises(mortise.Error, match=f"has {len(stack)} shapes"):
            mortise.judge(Workplane(*stack), cube())


def test_poses():
    pose = np.eye(4)
    pose[:3, 3] = [13, 0, 0]
    a, b = cube(), cube()
    assert mortise.distance(a, b, X_WB=pose).distance_mm == mortise.distance(a, b, X_WB=(13, 0, 0)).distance_mm == 3.0
    far = mortise.distance(a, b, X_WB=pose, limit_mm=1)
    assert not far.within_limit and far.distance_mm == 1.0
    scaled = np.eye(4) * 2
    for bad in (scaled, np.eye(3), [1, 2], "x", np.diag([1, 1, -1, 1.0]), np.full((4, 4), np.nan)):
        with pytest.raises(mortise.Error):
            mortise.distance(a, b, X_WB=bad)


def test_first_contact():
    hit = mortise.first_contact(cube(), cube(), start=[0, 0, 20], end=[0, 0, 0])
    assert hit.state == "contact" and hit.t_contact == pytest.approx(0.5, abs=1e-6) and hit.t_clear <= hit.t_contact
    assert mortise.first_contact(cube(), cube(), start=[0, 0, 20], end=[30, 0, 20], path="screw").state == "free"
    with pytest.raises(mortise.Error):
        mortise.first_contact(cube(), cube(), None, None, path="wavy")


def test_session():
    session = mortise.Session()
    session.add(cube(), fixed=True)
    box = session.add(cube(name="box"), pose=[0, 0, 12])
    session.hold("ann", box)
    assert session.push(box, [0, 0, -1]).clashes == []
    held = session.push(box, [0, 0, -5])
    assert held.pose[2, 3] == pytest.approx(10, abs=1e-3)
    assert [clash.part_b for clash in held.clashes] == ["box"]
    assert session.clashes[0].id == held.clashes[0].id
    with pytest.raises(mortise.Error, match="no such part"):
        session.push(mortise.Session().find("none"), [0, 0, 1])
    with pytest.raises(mortise.Error, match="no such part"):  # the first failure stays
        session.push(box, [0, 0, 1])


def scene_of_pegs():
    scene = mortise.Scene()
    assert scene.add(plate(), fixed=True) == "plate"
    assert scene.add((10 * CORNERS, SIDES), pose=[200, 0, 0], name="block") == "block"
    assert [scene.add(peg(), pose=[100 * i, 0, 100]) for i in range(2)] == ["peg", "peg_2"]
    scene.fit("plate", "peg", "H7/p6")
    return scene


def test_a_scene_judges_all_pairs_at_poses():
    scene = scene_of_pegs()
    assert list(scene.parts) == ["plate", "block", "peg", "peg_2"] and scene.parts["block"].points.shape == (8, 3)
    assert scene.poses["peg_2"][:3, 3].tolist() == [100, 0, 100]
    assert len(scene.judge()) == 0
    judged = scene.judge({"peg": [0, 0, -10], "peg_2": [205, 0, 0]})
    assert {(c.part_a, c.part_b): c.collision_class for c in judged} == {("plate", "peg"): "real", ("block", "peg_2"): "real"}
    assert judged[0] is not None and judged.worst == "real" and "H7/p6" in judged._repr_html_()
    alone = mortise.judge(plate(), peg(), fit="H7/p6", X_WB=[0, 0, -10]).clashes[0]
    ours = next(c for c in judged if c.part_b == "peg")
    assert ours.depth_mm == alone.depth_mm and ours.margin_mm == alone.margin_mm  # the same bits, not nearly
    scene.exclude("block", "peg_2")
    assert [c.part_b for c in scene.judge()] == ["peg"]


def test_a_scene_is_judged_along_poses():
    scene = scene_of_pegs()
    heights = [100, 40, 0, -10]
    judged = scene.judge_along("peg", [[0, 0, z] for z in heights])
    assert [j.worst for j in judged][0] == "none" and judged[-1].worst == "real" and len(judged) == 4
    assert scene.poses["peg"][2, 3] == 100  # it stands where it was
    with pytest.raises(mortise.Error, match="pose"):
        scene.judge_along("peg", [[0, 0, 1], "x"])
    assert scene.poses["peg"][2, 3] == 100


def test_what_is_wrong_with_a_scene():
    scene = scene_of_pegs()
    for call in (lambda: scene.place("pin", None), lambda: scene.judge({"pin": None}), lambda: scene.fit("plate", "pin", "H7/g6"),
                 lambda: scene.judge_along("pin", [None])):
        with pytest.raises(mortise.Error, match="no part 'pin' in the scene; there is: plate, block, peg, peg_2"):
            call()
    assert len(scene.judge()) == 0  # nothing of it stays
    scene.fit("plate", "peg_2", "H7/quite loose")
    with pytest.raises(mortise.Error, match="quite loose"):
        scene.judge()
    with pytest.raises(mortise.Error):
        mortise.Scene().judge()


@needs_step
def test_a_scene_of_an_assembly():
    scene = mortise.Scene()
    for part, pose in mortise.load_assembly(TENSIONER):
        scene.add(part, pose)
    real = {frozenset((c.part_a, c.part_b)) for c in scene.judge() if c.collision_class == "real"}
    said = {frozenset((p.part_a, p.part_b)) for p in mortise.check(TENSIONER).pairs if p.collision_class == "real"}
    assert frozenset(("cover", "bracket")) in real and said


@needs_step
def test_check(tmp_path):
    report = mortise.check(TENSIONER)
    said = subprocess.run([BIN / "mortise-check", TENSIONER, "--json"], text=True, capture_output=True, check=True).stdout
    assert report.json_text == said
    assert report.counts["unexplained_real"] == 1 and report.counts["explained_real"] == 7
    (worst,) = report.clashes
    assert (worst.collision_class, worst.part_a, worst.part_b, worst.relation) == ("real", "cover", "bracket", "unknown")
    place = worst.places[0]
    assert place.depth_mm[0] == pytest.approx(0.4) and place.way_out.part == "cover"
    assert place.way_out.path == "blocked" and place.way_out.translation_mm[2] < -0.39
    assert report._repr_html_().startswith("<p>1 unexplained real, 7 explained real") and "explained real</td>" in report._repr_html_()
    assert "cover × bracket" in report._repr_html_() and "cover × bracket" in report.text
    old = report.json()
    del old["pairs"][0]
    (tmp_path / "old.json").write_text(json.dumps(old))
    again = mortise.check(str(TENSIONER), baseline=tmp_path / "old.json", html=True)
    assert len(again.json()["baseline"]["new"]) == 1
    assert again._repr_html_().startswith("<iframe") and "<svg" in again.html
    with pytest.raises(mortise.Error):
        mortise.check(TENSIONER, unit="mile")
    with pytest.raises(mortise.Error, match="no such file"):
        mortise.check("none.step")
    with pytest.raises(mortise.Error) as raised:
        mortise.load("none.stl")
    assert raised.value.code == "not_found"


@needs_step
def test_an_assembly_in_parts():
    parts = mortise.load_assembly(TENSIONER)
    assert len(parts) == 19
    part, pose = parts[0]
    assert isinstance(part, mortise.Part) and pose.shape == (4, 4) and np.linalg.det(pose) == pytest.approx(1)
    with pytest.raises(mortise.Error, match="19 parts"):
        mortise.load(TENSIONER)


def test_picture():
    svg = mortise.picture(plate(), peg(), fit="H7/p6", X_WB=[0, 0, -10])
    assert "<svg" in svg and svg._repr_svg_() == svg


def test_log():
    log = mortise.Log(LOG)
    assert log.complete and log.session
    begin = log["clashes"]["begin_tick"]
    assert begin.shape == (1,) and begin.dtype == np.float64
    assert log["parts"]["part"].dtype == object and "cube" in log["parts"]["part"]
    assert "clashes" in log.keys() and "<table>" in log._repr_html_()
    assert mortise.verify_log(str(LOG)) == 68
    with pytest.raises(mortise.Error):
        mortise.Log(TENSIONER)


def test_columns_of_a_log_in_pandas():
    pytest.importorskip("pandas", reason="program absent: python3-pandas (packages-bench.txt)")
    log = mortise.Log(LOG)
    for name in log.keys():
        frame = log.frame(name)
        assert list(frame.columns) == list(log[name])
        assert all((frame[column].to_numpy() == log[name][column]).all() or frame[column].dtype == float for column in frame)
    clashes = log.frame("clashes")
    assert clashes["begin_tick"].dtype == np.float64 and clashes["begin_tick"][0] == log["clashes"]["begin_tick"][0]


def test_threads_run_beside_each_other():
    a, b = plate(), peg()
    alone = mortise.judge(a, b, fit="H7/p6", X_WB=[0, 0, -10]).json_text
    answers, ticks = [], 0
    workers = [threading.Thread(target=lambda: answers.append(mortise.judge(a, b, fit="H7/p6", X_WB=[0, 0, -10]).json_text))
               for _ in range(2)]
    for worker in workers:
        worker.start()
    while any(worker.is_alive() for worker in workers):
        ticks += 1  # with the GIL held this loop would not be entered before the end
    for worker in workers:
        worker.join()
    assert answers == [alone, alone] and ticks > 0


def test_a_trivial_call_costs_little():
    part, far = cube(), cube().named("far")
    pose = np.eye(4)
    pose[0, 3] = 1e6
    mortise.distance(part, far, X_WB=pose, limit_mm=0.0)

    def least_us(call, count=2000):
        best = float("inf")
        for _ in range(20):
            start = time.perf_counter()
            for _ in range(count):
                call()
            best = min(best, (time.perf_counter() - start) / count)
        return 1e6 * best

    name = least_us(lambda: part.triangle_count)
    distance = least_us(lambda: mortise._mortise.distance(part, far, None, pose, 0.0))
    print(f"triangle_count {name:.2f} µs, distance of two boxes far apart {distance:.2f} µs")
    if float(os.environ.get("MORTISE_EFFORT", "1")) > 1:  # durations are held in a soak alone
        assert name <= 5.0 and distance <= 5.0


def test_a_live_session(tmp_path, domain):
    server = subprocess.Popen([BIN / "mortise-server", SOURCE / "scenarios" / "peg_in_hole.yaml", "--session", "python", "--domain",
                               str(domain), "--quiet", "--log", tmp_path / "s.mcap"], stdout=subprocess.DEVNULL)
    try:
        with mortise.Client("ann", session="python", domain=domain) as ann:
            movable = [part for part in ann.parts.values() if part.moving]
            name = movable[0].name
            with pytest.raises(mortise.Error, match="no part 'nobody'"):
                ann.grab("nobody")
            ann.grab(name)
            before = ann.parts[name].pose.copy()
            events = []
            for _ in range(40):
                ann.move(name, [0, 0, -0.5])
                events += ann.listen(0.02).events
            events += ann.listen(0.5).events
            after = ann.parts[name]
            assert after.holder == "ann" and after.pose[2, 3] < before[2, 3]
            assert all(event.clash.collision_class in ("fake", "potential", "real") for event in events)
            with mortise.Client("bob", session="python", domain=domain) as bob:
                with pytest.raises(mortise.Error, match="does not let 'bob' hold"):
                    bob.grab(name)
            ann.release(name)
        with pytest.raises(mortise.Error, match="has left"):
            ann.listen(0)
        with pytest.raises(mortise.Error) as raised:
            mortise.Client("ann", session="no_such", domain=domain, wait_s=0.5)
        assert raised.value.code == "not_found"
    finally:
        server.terminate()
        assert server.wait(20) == 0
    assert "ann" in mortise.Log(tmp_path / "s.mcap")["users"]["user"]


def test_a_server_that_is_gone_is_said_at_once(tmp_path, domain):
    server = subprocess.Popen([BIN / "mortise-server", SOURCE / "scenarios" / "peg_in_hole.yaml", "--session", "python", "--domain",
                               str(domain), "--quiet", "--log", tmp_path / "s.mcap"], stdout=subprocess.DEVNULL)
    with mortise.Client("ann", session="python", domain=domain) as ann:
        name = next(part.name for part in ann.parts.values() if part.moving)
        server.kill()
        server.wait(20)
        begun_s = time.monotonic()
        with pytest.raises(mortise.Error, match="went away before it answered; see whether it was done"):
            ann.grab(name)
        assert time.monotonic() - begun_s < 4.5
        with pytest.raises(mortise.Error, match="not joined"):
            ann.grab(name)


def test_every_public_thing_is_explained_and_typed():
    stub = pathlib.Path(mortise.__file__).with_name("__init__.pyi").read_text()
    for name in mortise.__all__:
        thing = getattr(mortise, name)
        assert thing.__doc__, name
        assert f"def {name}(" in stub or f"class {name}" in stub, name
        if isinstance(thing, type):
            for member in vars(thing):
                assert member.startswith("_") or f"{member}" in stub, f"{name}.{member}"
