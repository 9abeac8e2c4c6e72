"""Every document that a program writes with --json holds its schema in client/schemas, and has no key that it does not name."""

import copy
import json
import os
import pathlib
import re
import subprocess

import jsonschema
import pytest

BIN = pathlib.Path(os.environ["MORTISE_BIN"])
SOURCE = pathlib.Path(os.environ["MORTISE_SOURCE"])
SCHEMAS = SOURCE / "client" / "schemas"
SCENARIOS = SOURCE / "scenarios"
TENSIONER = SCENARIOS / "tensioner.step"
LOGS = [SOURCE / "tests" / "golden" / name for name in ("thin_wall.mcap", "thin_wall_slide.mcap")]
needs_step = pytest.mark.skipif(not (BIN / "mortise-import-step").exists(), reason="program absent: OpenCASCADE")

ALL = {path.name: json.loads(path.read_text()) for path in SCHEMAS.glob("*.schema.json")}


def strict(schema):
    """The same with no other keys than those that are named."""
    if isinstance(schema, list):
        return [strict(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {key: strict(value) for key, value in schema.items()}
    if "properties" in schema and "allOf" not in schema:
        closed.setdefault("additionalProperties", False)
    return closed


def errors(name, document, closed=True):
    make = strict if closed else (lambda schema: schema)
    schema = make(ALL[f"{name}.schema.json"])
    resolver = jsonschema.RefResolver("", schema, store={key: make(value) for key, value in ALL.items()})
    return [error.json_path + ": " + error.message for error in
            jsonschema.Draft202012Validator(schema, resolver=resolver).iter_errors(document)]


def said(program, *words, codes=(0,), cwd=None):
    done = subprocess.run([BIN / f"mortise-{program}", *map(str, words)], text=True, capture_output=True, cwd=cwd, check=False)
    assert done.returncode in codes, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for words in (["plate_with_bore", "bore_mm=20", "facets=32", "-o", "plate.stl"],
                  ["dowel", "diameter_mm=20", "length_mm=40", "chamfer_mm=1", "facets=32", "-o", "peg.stl"]):
        subprocess.run([BIN / "mortise-generate", *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return folder


def hold(name, document):
    assert errors(name, document) == []


def test_the_schemas_are_schemas():
    assert len(ALL) == 18
    for name, schema in ALL.items():
        jsonschema.Draft202012Validator.check_schema(schema)
        assert schema["$id"] == name and re.search(r", version \d+$", schema["title"]) and schema["description"]


@pytest.mark.parametrize("scenario", sorted(path.name for path in SCENARIOS.glob("*.yaml") if ".play." not in path.name))
def test_scenarios(scenario):
    if scenario == "stress.yaml":
        pytest.skip("machine: takes long")
    hold("lint", said("lint", SCENARIOS / scenario, "--json"))
    hold("judge", said("judge", SCENARIOS / scenario, "--json"))


def test_what_is_wrong_with_a_scenario(tmp_path):
    (tmp_path / "bad.yaml").write_text("name: bad\nunits: mm\n")
    document = said("lint", tmp_path / "bad.yaml", "--json", codes=(3,))
    hold("lint", document)
    assert not document["usable"] and document["findings"]


def test_a_scenario_to_which_parts_are_added_later(tmp_path):
    (tmp_path / "empty.yaml").write_text("name: empty\nunits: mm\nparts: []\n")
    document = said("lint", tmp_path / "empty.yaml", "--json")
    hold("lint", document)
    assert document["usable"] and document["findings"]


def test_meshes(meshes):
    hold("judge", said("judge", "plate.stl", "peg.stl", "--fit", "H7/p6", "--json", cwd=meshes))
    hold("judge", said("judge", "plate.stl", "peg.stl", "--fit", "H7/p6", "--json", "--apply-way", cwd=meshes))
    hold("check", said("check", "plate.stl", "peg.stl", "--json", "--min-gap", "1", cwd=meshes))
    hold("inspect", said("inspect", "plate.stl", "peg.stl", "--json", cwd=meshes))
    hold("inspect", said("inspect", SCENARIOS / "gearbox.yaml", "--json"))


def test_first_contacts(meshes):
    pose = "{0}_x,{0}_y,{0}_z,{0}_qw,{0}_qx,{0}_qy,{0}_qz"
    lines = ["id,path,ref_x,ref_y,ref_z," + pose.format("start") + "," + pose.format("end")]
    for name, x, start, end in (("in", 5, 100, -10), ("by", 60, 300, 200), ("held", 5, -10, -20)):
        lines.append(f"{name},linear,0,0,0,{x},0,{start},1,0,0,0,{x},0,{end},1,0,0,0")
    (meshes / "motions.csv").write_text("\n".join(lines) + "\n")
    words = ("--moving", "peg.stl", "--static", "plate.stl", "--motions", "motions.csv")
    document = said("first-contact", *words, "--json", cwd=meshes)
    hold("first-contact", document)
    assert [m["state"] for m in document["motions"]] == ["contact", "free", "overlapping_at_start"]
    assert document["counts"]["free"] == 1 and document["motions"][0]["point_mm"] and document["motions"][1]["point_mm"] is None
    both = said("first-contact", *words, "--json", "--out", "out.csv", cwd=meshes)  # the table says the same
    table = [line.split(",") for line in (meshes / "out.csv").read_text().splitlines()[1:]]
    assert [(row[0], float(row[2])) for row in table] == [(m["id"], m["t_clear"]) for m in both["motions"]]
    assert errors("first-contact", {**document, "motions": [{**document["motions"][0], "state": "hit"}]}, closed=False)
    assert subprocess.run([BIN / "mortise-first-contact", *words], cwd=meshes, capture_output=True, check=False).returncode == 2


@needs_step
def test_assemblies(tmp_path):
    hold("inspect-step", said("inspect", TENSIONER, "--json"))
    document = said("check", TENSIONER, "--json", "--min-gap", "2")
    hold("check", document)
    assert document["near"] and document["pairs"][0]["verdicts"][0]["separation"]["blocker"]
    old = copy.deepcopy(document)
    del old["pairs"][0]
    old["pairs"][0]["verdicts"][0]["delta_mm"][0] += 1
    (tmp_path / "old.json").write_text(json.dumps(old))
    compared = said("check", TENSIONER, "--json", "--baseline", tmp_path / "old.json", "--fail-on", "new", codes=(6,))
    hold("check", compared)
    assert len(compared["baseline"]["new"]) == 1 and len(compared["baseline"]["changed"]) == 1


@needs_step
def test_the_job_of_ci_fails_on_a_new_clash_alone(tmp_path):
    lines = [line.strip() for line in (SCHEMAS / "clashes.yml").read_text().splitlines()]
    before = next(line for line in lines if line.startswith("mortise-check before.step"))
    after = next(line for line in lines if line.startswith("run: mortise-check assembly.step")).removeprefix("run: ")
    (tmp_path / "before.step").write_bytes(TENSIONER.read_bytes())
    (tmp_path / "assembly.step").write_bytes(TENSIONER.read_bytes())
    environment = dict(os.environ, PATH=f"{BIN}:{os.environ['PATH']}")

    def run(line):
        return subprocess.run(line, shell=True, cwd=tmp_path, env=environment, capture_output=True, check=False).returncode

    assert run(before) == 0 and run(after) == 0
    assert (tmp_path / "clashes.xml").exists() and (tmp_path / "clashes.html").exists()
    document = json.loads((tmp_path / "before.json").read_text())
    del document["pairs"][0]  # as if the clash had not been there before
    (tmp_path / "before.json").write_text(json.dumps(document))
    assert run(after) == 6


@pytest.mark.parametrize("log", LOGS, ids=lambda path: path.stem)
def test_logs(log, tmp_path):
    for command in ("verify", "report", "info"):
        hold(f"replay-{command}", said("replay", command, log, "--json"))
    hold("replay-explain", said("replay", "explain", log, "1", "--json"))
    hold("replay-recover", said("replay", "recover", log, "--out", tmp_path / "new.mcap", "--json"))
    hold("replay-whatif", said("replay", "whatif", log, "--set", "tolerance cube = ±0.02", "--json"))
    hold("replay-whatif", said("replay", "whatif", log, "--sweep", "tolerance cube = ±[0.005..0.03/3]", "--json"))
    subprocess.run([BIN / "mortise-replay", "export", log, "--json", tmp_path / "tables.json"], check=True, capture_output=True)
    hold("replay-export", json.loads((tmp_path / "tables.json").read_text()))


def test_a_log_of_which_nothing_is_replayable(tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(LOGS[0].read_bytes()[:400])
    document = said("replay", "recover", cut, "--out", tmp_path / "new.mcap", "--json", codes=(7,))
    hold("replay-recover", document)
    assert document["not_replayable"] and not (tmp_path / "new.mcap").exists()
    assert errors("replay-recover", document | {"ticks": 3}) != [], "one of the two documents"
    assert errors("replay-recover", {"log": "a.mcap"}) != []


def test_a_live_session(tmp_path, domain):
    def program(name, *words):
        return subprocess.Popen([BIN / f"mortise-{name}", *map(str, words), "--json", "--quiet"], cwd=tmp_path, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)

    def document_of(running, stop=False):
        if stop:
            running.terminate()
        out, _ = running.communicate(timeout=60)
        assert running.returncode == 0
        return json.loads(out)

    server = program("server", SCENARIOS / "peg_in_hole.yaml", "--session", "schemas", "--domain", domain, "--log", "s.mcap")
    discovery = program("discovery", "--discovery-port", 20000 + domain)
    bots = ("bot", "--session", "schemas", "--domain", domain, "--wait", 30, "--seconds", 2)
    try:
        alone = program(*bots, "--behaviour", "guided", "--tries", 1, "--limit", "lost_events=0")
        seen = said("directory", "--domain", domain, "--wait", "2", "--json")
        hold("directory", seen)
        assert [row["session"] for row in seen["servers"]] == ["schemas"]
        document = document_of(alone)
        hold("bot", document)
        assert document["limits"][0]["holds"] and "insertions" in document
        many = document_of(program(*bots, "--processes", 2, "--users", 2))
        hold("bot", many)
        assert many["processes"] == 2 and len(many["participants"]) == 2
        hold("discovery", document_of(discovery, stop=True))
        closing = document_of(server, stop=True)
        hold("server", closing)
        assert closing["users"] and errors("server", {**closing, "log": "s.mcap"}, closed=False)
    finally:
        for running in (server, discovery):
            running.kill()


def planted(document):
    """Documents with one fault each."""
    def without(key):
        bad = copy.deepcopy(document)
        del bad[key]
        return bad

    def changed(path, value):
        bad = copy.deepcopy(document)
        at = bad
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = value
        return bad

    verdict = ("pairs", 0, "verdicts", 0)
    yield "a key is missing", without("counters")
    yield "the class is another word", changed(verdict + ("class",), "deep")
    yield "an interval has one end", changed(verdict + ("delta_mm",), [0.1])
    yield "a vector has words", changed(verdict + ("point_mm",), ["x", "y", "z"])
    yield "a number is text", changed(verdict + ("margin_mm",), "0.1")
    yield "another version", changed(("schema",), "mortise/judge/2")


def test_planted_faults_are_found(meshes):
    document = said("judge", "plate.stl", "peg.stl", "--fit", "H7/p6", "--json", cwd=meshes)
    hold("judge", document)
    for what, bad in planted(document):
        assert errors("judge", bad, closed=False), what
    new = dict(document, new_key=1)
    assert errors("judge", new) and not errors("judge", new, closed=False)
