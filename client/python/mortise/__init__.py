"""Is a collision of CAD parts real, potential or fake?

    import mortise
    for pair in mortise.check("arm.step").clashes:
        print(pair.collision_class, pair.part_a, pair.part_b, pair.relation, pair.places[0].depth_mm)

Lengths are mm, angles rad, world frame. Where a part is asked for, a Part, the path of a mesh or STEP file, a pair
(points, triangles), an object with `vertices` and `faces` (trimesh), or a shape of CadQuery or build123d may be given. The last is
made into a mesh with chords of 0.01 mm; a STEP file of it keeps its exact surfaces. A pose is None, a shift of three numbers, or
a 4 x 4 matrix. What goes wrong raises mortise.Error. Functions release the GIL; a Session or Client is for one thread at a time.
"""

import html as _html
import json as _json
import os as _os

from . import _mortise
from ._error import Error
from ._mortise import (CheckedPair, CheckReport, Clash, Distance, Feature, FirstContact, Heard, Judgement, LiveEvent, LivePart,
                       Part, PartRef, Pushed, WayOut, verify_log, version)

__version__ = version()
__all__ = ["CheckReport", "CheckedPair", "Clash", "Client", "Distance", "Error", "Feature", "FirstContact", "Heard", "Judgement",
           "LiveEvent", "LivePart", "Log", "Part", "PartRef", "Pushed", "Scene", "Session", "WayOut", "check", "distance",
           "first_contact", "judge", "load", "load_assembly", "picture", "verify_log", "version"]


def load(file, unit="mm"):
    """Reads one part: STL, OBJ, PLY, glTF, GLB, DAE, or a STEP file of a single part with its exact surfaces. unit: of the
    numbers in a mesh file (mm, cm, m, in, um)."""
    return _mortise.load(_os.fspath(file), unit)


def load_assembly(file):
    """Reads all parts of a STEP assembly: a list of (Part, 4 x 4 pose)."""
    return _mortise.load_assembly(_os.fspath(file))


_CHORD_MM = 0.01  # of shapes that are made into meshes here


def _part(of, name):
    if isinstance(of, Part):
        return of
    if isinstance(of, (str, _os.PathLike)):
        return load(of)
    if hasattr(of, "vals"):  # a Workplane of CadQuery: what it has made last
        shapes = of.vals()
        if len(shapes) != 1:
            raise Error(f"{name}: the workplane has {len(shapes)} shapes; combine them, or give one")
        of = shapes[0]
    if hasattr(of, "tessellate"):  # a shape of CadQuery or build123d
        points, triangles = of.tessellate(_CHORD_MM)
        return Part([tuple(p.toTuple() if hasattr(p, "toTuple") else p) for p in points], triangles, name)
    if hasattr(of, "vertices") and hasattr(of, "faces"):
        return Part(of.vertices, of.faces, name)
    points, triangles = of
    return Part(points, triangles, name)


class _Picture(str):
    """SVG text that a notebook shows."""

    def _repr_svg_(self):
        return str(self)


def judge(a, b, fit="", X_WA=None, X_WB=None, full=False, threads=1):
    """Judges two parts where they stand, with the same bits as `mortise judge A B --json`. fit: of hole and shaft, "H7/g6".
    full: refine every bracket to 1e-4 mm."""
    return _mortise.judge(_part(a, "a"), _part(b, "b"), fit, X_WA, X_WB, full, threads)


def distance(a, b, X_WA=None, X_WB=None, limit_mm=float("inf")):
    """Distance of two meshes, exact to rounding. limit_mm: nothing beyond is of interest."""
    return _mortise.distance(_part(a, "a"), _part(b, "b"), X_WA, X_WB, limit_mm)


def first_contact(a, b, start, end, X_WB=None, path="linear", accuracy_mm=1e-6, separation_mm=0.0):
    """When a, which moves from start to end, first touches b, which stands at X_WB. Never a miss, never late. path: linear
    (straight, about the centre of the part) or screw."""
    return _mortise.first_contact(_part(a, "a"), _part(b, "b"), start, end, X_WB, path, accuracy_mm, separation_mm)


def picture(a, b, fit="", X_WA=None, X_WB=None):
    """The worst place of two parts in section, as SVG text; a notebook draws it."""
    return _Picture(_mortise.picture_svg(_part(a, "a"), _part(b, "b"), fit, X_WA, X_WB))


def check(*files, min_gap_mm=0.0, no_explain=(), bought=(), general="", fit="", unit="mm", baseline="", exact_volumes=True,
          html=False, threads=2):
    """Judges an assembly as it stands, with the same bits as `mortise check --json`: one STEP file or scenario, or two or more
    meshes. html: also make the page with pictures, which a notebook shows.

    Of the report: clashes (nothing explains them), pairs (all), counts, near, not_judged, notes, text, json()."""
    options = _mortise.CheckOptions()
    options.min_gap_mm, options.general, options.fit = min_gap_mm, general, fit
    options.no_explain, options.bought = list(no_explain), list(bought)
    options.baseline = _os.fspath(baseline)
    options.exact_volumes, options.html, options.threads = exact_volumes, html, threads
    options.set_unit(unit)
    return _mortise.check([_os.fspath(file) for file in files], options)


class Session(_mortise.Session):
    """Parts that users hold and push in this process, each collision judged. policy: stop, slide or report. What fails once
    makes everything after it fail with the same reason."""

    def add(self, part, pose=None, fixed=False):
        """Adds a part; a fixed one stands."""
        return super().add(_part(part, "part"), pose, fixed)


class Scene:
    """Parts at poses, all pairs judged; nothing is held or pushed.

        scene = mortise.Scene()
        scene.add("plate.stl", fixed=True)
        scene.add((points, triangles), name="pin")
        scene.fit("plate", "pin", "H7/g6")
        for clash in scene.judge({"pin": [0, 0, -10]}):
            print(clash.collision_class, clash.part_a, clash.part_b, clash.depth_mm)

    Parts have names. Two fixed parts are no pair. A statement that does not hold, as a fit that is none, is told by judge()."""

    def __init__(self, threads=1):
        self._session = Session(policy="report", threads=threads)
        self._parts = {}

    def add(self, part, pose=None, name=None, fixed=False):
        """Adds a part; returns the name by which it is asked for: `name` or its own, with a number where that is taken."""
        part = _part(part, name or "part")
        if name is not None:
            part = part.named(name)
        ref = self._session.add(part, pose, fixed)
        self._parts[self._session.name(ref)] = (part, ref)
        return self._session.name(ref)

    def _find(self, name):
        if name not in self._parts:
            raise Error(f"there is no part '{name}' in the scene; there is: {', '.join(self._parts) or 'none'}")
        return self._parts[name][1]

    @property
    def parts(self):
        """{name: Part}; its points and triangles are numpy arrays."""
        return {name: part for name, (part, _) in self._parts.items()}

    @property
    def poses(self):
        """{name: 4 x 4} where the parts stand."""
        return {name: self._session.pose(ref) for name, (_, ref) in self._parts.items()}

    def place(self, name, pose):
        """Puts a part somewhere."""
        self._session.place(self._find(name), pose)

    def fit(self, a, b, code, feature_a="", feature_b=""):
        """States a fit, "H7/g6", of two features; "": of the hole and the shaft of the parts."""
        self._session.fit(self._find(a), feature_a, self._find(b), feature_b, code)

    def tolerance(self, name, text, feature=""):
        """States a tolerance, "±0.02" or "H7", of a feature; "": of the whole part."""
        self._session.tolerance(self._find(name), feature, text)

    def exclude(self, a, b, reason="excluded"):
        """The pair is never judged."""
        self._session.exclude(self._find(a), self._find(b), reason)

    def judge(self, poses=None, full=False):
        """Judges all pairs: a Judgement, which is a list of Clash. poses: {name: pose} of parts to be put somewhere before."""
        for name, pose in (poses or {}).items():
            self.place(name, pose)
        return self._session.judge(full)

    def judge_along(self, name, poses, full=False):
        """A list with one Judgement of all pairs for each pose of this part, which stands again where it was afterwards."""
        before = self._session.pose(self._find(name))
        try:
            return [self.judge({name: pose}, full) for pose in poses]
        finally:
            self.place(name, before)


class Client:
    """A user of a live session; use it in a `with` statement. Call listen() at least five times a second, or the user counts as
    absent."""

    def __init__(self, user, session="default", domain=0, interface="127.0.0.1", server="", discovery_server="",
                 discovery_port=0, keys="", role="designer", wait_s=10.0):
        options = _mortise.ClientOptions()
        options.session, options.domain, options.interface, options.server = session, domain, interface, server
        options.discovery_server, options.discovery_port = discovery_server, discovery_port
        options.keys, options.role, options.wait_s = _os.fspath(keys), role, wait_s
        self._raw = _mortise.join(user, options)

    def _joined(self):
        if self._raw is None:
            raise Error("the client has left")
        return self._raw

    @property
    def parts(self):
        """{name: LivePart} of the session."""
        return {part.name: part for part in self._joined().parts()}

    @property
    def open_clashes(self):
        """Clash each, the worst first."""
        return self._joined().open_clashes()

    @property
    def server_present(self):
        return self._joined().server_present()

    def grab(self, part):
        """Waits for the answer; raises Error when refused."""
        self._joined().grab(part)

    def release(self, part):
        """Waits for the answer; raises Error when refused."""
        self._joined().release(part)

    def move(self, part, dX_W):
        """Sends a push: the pose becomes dX_W @ pose, as far as the session lets it. Returns at once."""
        self._joined().move(part, dX_W)

    def listen(self, seconds=0.1):
        """Takes what comes for so long: Heard."""
        return self._joined().listen(seconds)

    def close(self):
        """Leaves the session."""
        self._raw = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Log:
    """The log of a session: log["clashes"]["begin_tick"] is a column as a numpy array (texts: of objects). frame("clashes") is a
    DataFrame where pandas is there."""

    def __init__(self, file):
        raw = _mortise.read_log(_os.fspath(file))
        self.session, self.complete, self.notes = raw.session, raw.complete, raw.notes
        self.tables = raw.tables()

    def __getitem__(self, table):
        return self.tables[table]

    def keys(self):
        """Names of the tables."""
        return self.tables.keys()

    def frame(self, table):
        """A table as a DataFrame of pandas."""
        import pandas
        return pandas.DataFrame(self.tables[table])

    def _repr_html_(self):
        rows = [(name, len(next(iter(columns.values()), ())), ", ".join(columns)) for name, columns in self.tables.items()]
        return f"<p>session {_html.escape(self.session)}</p>" + _table(("table", "rows", "columns"), rows)


_COLOURS = {"real": "#b3261e", "potential": "#9a6700", "fake": "#1f6feb", "none": "#57606a"}


def _table(head, rows):
    def cell(tag, value):
        colour = _COLOURS.get(value) if tag == "td" and isinstance(value, str) else None
        style = f' style="color:{colour};font-weight:bold"' if colour else ""
        return f"<{tag}{style}>{_html.escape(str(value))}</{tag}>"

    lines = ["<tr>" + "".join(cell("th", h) for h in head) + "</tr>"]
    lines += ["<tr>" + "".join(cell("td", value) for value in row) + "</tr>" for row in rows]
    return "<table>" + "".join(lines) + "</table>"


def _depth(clash):
    return "[{:.4f}, {:.4f}]".format(*clash.depth_mm)


def _judgement_html(self):
    rows = [(c.collision_class, f"{c.part_a} × {c.part_b}", _depth(c), c.explanation) for c in self.clashes]
    return _table(("class", "parts", "depth, mm", "why"), rows) if rows else "<p>nothing meets</p>"


def _check_html(self):
    if self.html:
        return f'<iframe srcdoc="{_html.escape(self.html)}" style="width:100%;height:640px;border:0"></iframe>'
    counts = ", ".join(f"{self.counts[name]} {name.replace('_', ' ')}" for name in self.json()["counts"])  # the worst first
    rows = [("contact" if p.contact else f"{'explained ' if p.explained else ''}{p.collision_class}", f"{p.part_a} × {p.part_b}", p.relation,
             _depth(p.places[0]) if p.places else "", p.reason or (p.places[0].explanation if p.places else ""))
            for p in self.pairs]
    return f"<p>{_html.escape(counts)}</p>" + _table(("class", "parts", "relation", "depth, mm", "why"), rows)


def _document(self):
    """The document of the program as a dictionary; client/schemas describes it."""
    return _json.loads(self.json_text)


Judgement.__len__, Judgement.__iter__ = lambda self: len(self.clashes), lambda self: iter(self.clashes)
Judgement.__getitem__ = lambda self, index: self.clashes[index]
Judgement._repr_html_, Judgement.json = _judgement_html, _document
CheckReport._repr_html_, CheckReport.json = _check_html, _document
