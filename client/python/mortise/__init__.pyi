import os
from typing import Any, Iterable, Iterator, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
_Array = NDArray[np.float64]
_Pose = Optional[ArrayLike]
_File = Union[str, "os.PathLike[str]"]
_Shape = Any  # Part, path, (points, triangles), an object with vertices and faces, or one with tessellate(tolerance)

class Error(Exception):
    code: str

class Feature:
    name: str
    kind: str
    point: _Array
    axis: _Array
    radius_mm: float
    tube_radius_mm: float
    half_angle_rad: float
    inward: bool
    residual_mm: float

class Part:
    def __init__(self, points: ArrayLike, triangles: ArrayLike, name: str = "part") -> None: ...
    @staticmethod
    def generate(kind: str, name: str = "part", **parameters: float) -> Part: ...
    def named(self, name: str) -> Part: ...
    def save(self, file: str) -> None: ...
    name: str
    triangle_count: int
    points: _Array
    triangles: NDArray[np.uint32]
    volume_mm3: float
    has_inside: bool
    hash: str
    notes: list[str]
    features: list[Feature]

class WayOut:
    part: str
    translation_mm: _Array
    rotation_rad: _Array
    about_mm: _Array
    way: str
    path: str
    blocker: str

class Clash:
    id: int
    part_a: str
    part_b: str
    collision_class: str
    depth_mm: tuple[float, float]
    way_out_mm: tuple[float, float]
    fake_up_to_mm: float
    real_above_mm: float
    margin_mm: float
    probability: Optional[float]
    point: _Array
    normal: _Array
    area_mm2: float
    witness: Optional[_Array]
    way_out: Optional[WayOut]
    face_a: str
    face_b: str
    grade: str
    explanation: str

class Judgement:
    clashes: list[Clash]
    notes: list[str]
    worst: str
    json_text: str
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Clash]: ...
    def __getitem__(self, index: int) -> Clash: ...
    def json(self) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...

class Distance:
    distance_mm: float
    within_limit: bool
    point_a: _Array
    point_b: _Array

class FirstContact:
    state: str
    t_clear: float
    t_contact: float
    distance_mm: float
    point_a: _Array
    point_b: _Array

class CheckedPair:
    part_a: str
    part_b: str
    collision_class: str
    contact: bool
    relation: str
    relation_text: str
    explained: bool
    reason: str
    count: int
    instances: list[tuple[str, str]]
    inside: str
    muted: bool
    accuracy_mm: float
    common_mm3: Optional[float]
    thickness_mm: Optional[float]
    places: list[Clash]
    is_clash: bool

class CheckReport:
    pairs: list[CheckedPair]
    clashes: list[CheckedPair]
    near: list[tuple[str, str, tuple[float, float]]]
    not_judged: list[str]
    notes: list[str]
    counts: dict[str, int]
    json_text: str
    text: str
    html: str
    def json(self) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...

class PartRef:
    value: int
    def __bool__(self) -> bool: ...

class Pushed:
    pose: _Array
    clashes: list[Clash]
    state_hash: int

class Session:
    def __init__(self, policy: str = "stop", max_jump_mm: float = 50.0, threads: int = 1) -> None: ...
    def add(self, part: _Shape, pose: _Pose = None, fixed: bool = False) -> PartRef: ...
    def fit(self, a: PartRef, feature_a: str, b: PartRef, feature_b: str, code: str) -> None: ...
    def tolerance(self, part: PartRef, feature: str, text: str) -> None: ...
    def exclude(self, a: PartRef, b: PartRef, reason: str = "excluded") -> None: ...
    def hold(self, user: str, part: PartRef) -> None: ...
    def release(self, part: PartRef) -> None: ...
    def place(self, part: PartRef, pose: _Pose) -> None: ...
    def push(self, part: PartRef, dX_W: _Pose) -> Pushed: ...
    def judge(self, full: bool = False) -> Judgement: ...
    clashes: list[Clash]
    def pose(self, part: PartRef) -> _Array: ...
    def name(self, part: PartRef) -> str: ...
    def find(self, name: str) -> PartRef: ...

class Scene:
    def __init__(self, threads: int = 1) -> None: ...
    def add(self, part: _Shape, pose: _Pose = None, name: Optional[str] = None, fixed: bool = False) -> str: ...
    @property
    def parts(self) -> dict[str, Part]: ...
    @property
    def poses(self) -> dict[str, _Array]: ...
    def place(self, name: str, pose: _Pose) -> None: ...
    def fit(self, a: str, b: str, code: str, feature_a: str = "", feature_b: str = "") -> None: ...
    def tolerance(self, name: str, text: str, feature: str = "") -> None: ...
    def exclude(self, a: str, b: str, reason: str = "excluded") -> None: ...
    def judge(self, poses: Optional[Mapping[str, _Pose]] = None, full: bool = False) -> Judgement: ...
    def judge_along(self, name: str, poses: Iterable[_Pose], full: bool = False) -> list[Judgement]: ...

class LivePart:
    name: str
    pose: _Array
    moving: bool
    holder: str

class LiveEvent:
    kind: str
    tick: int
    user: str
    clash: Clash

class Heard:
    events: list[LiveEvent]
    refused: list[str]
    server_lost: bool

class Client:
    def __init__(self, user: str, session: str = "default", domain: int = 0, interface: str = "127.0.0.1", server: str = "",
                 discovery_server: str = "", discovery_port: int = 0, keys: _File = "", role: str = "designer",
                 wait_s: float = 10.0) -> None: ...
    @property
    def parts(self) -> dict[str, LivePart]: ...
    @property
    def open_clashes(self) -> list[Clash]: ...
    @property
    def server_present(self) -> bool: ...
    def grab(self, part: str) -> None: ...
    def release(self, part: str) -> None: ...
    def move(self, part: str, dX_W: _Pose) -> None: ...
    def listen(self, seconds: float = 0.1) -> Heard: ...
    def close(self) -> None: ...
    def __enter__(self) -> Client: ...
    def __exit__(self, *_: object) -> None: ...

class Log:
    session: str
    complete: bool
    notes: list[str]
    tables: dict[str, dict[str, NDArray[Any]]]
    def __init__(self, file: _File) -> None: ...
    def __getitem__(self, table: str) -> dict[str, NDArray[Any]]: ...
    def keys(self) -> Iterable[str]: ...
    def frame(self, table: str) -> Any: ...
    def _repr_html_(self) -> str: ...

def load(file: _File, unit: str = "mm") -> Part: ...
def load_assembly(file: _File) -> list[tuple[Part, _Array]]: ...
def judge(a: _Shape, b: _Shape, fit: str = "", X_WA: _Pose = None, X_WB: _Pose = None, full: bool = False,
          threads: int = 1) -> Judgement: ...
def distance(a: _Shape, b: _Shape, X_WA: _Pose = None, X_WB: _Pose = None, limit_mm: float = ...) -> Distance: ...
def first_contact(a: _Shape, b: _Shape, start: _Pose, end: _Pose, X_WB: _Pose = None, path: str = "linear",
                  accuracy_mm: float = 1e-6, separation_mm: float = 0.0) -> FirstContact: ...
def picture(a: _Shape, b: _Shape, fit: str = "", X_WA: _Pose = None, X_WB: _Pose = None) -> str: ...
def check(*files: _File, min_gap_mm: float = 0.0, no_explain: Sequence[str] = (), bought: Sequence[str] = (), general: str = "",
          fit: str = "", unit: str = "mm", baseline: _File = "", exact_volumes: bool = True, html: bool = False,
          threads: int = 2) -> CheckReport: ...
def verify_log(file: str, threads: int = 1) -> int: ...
def version() -> str: ...
