"""The bodies of a document that are checked, and their STEP file. Needs no screen."""

import os
import re

import FreeCAD as App
import Import
import Part

MARK = "MortisePlace"  # the object that shows a place: never checked itself
_GROUPS = ("App::Part", "App::DocumentObjectGroup", "App::LinkGroup", "Assembly::AssemblyObject")


class Body:
    """A solid where it stands. `things`: the object of the document below which it lies, and so on down to its own; `path` leads there,
    as a selection names it. `shape` stands in the world."""

    def __init__(self, things, path, labels, shape):
        self.things, self.path, self.labels, self.shape = things, path, labels, shape
        self.name = ""  # unique among the bodies that are checked

    @property
    def root(self):
        return self.things[0]

    @property
    def thing(self):
        return self.things[-1]

    @property
    def label(self):
        return " / ".join(self.labels)


def _is_group(thing):
    return thing.TypeId in _GROUPS or thing.isDerivedFrom("App::DocumentObjectGroup")


def _is_consumed(thing):
    """Is it a step towards another body: a feature of a PartDesign body, or an operand of a Boolean?"""
    return any(not _is_group(user) and hasattr(user, "Shape") and not user.isDerivedFrom("App::Link") and user.Shape.Solids
               for user in thing.InList)


def _is_template(thing):
    """Is it there for links in groups alone? On a screen it is hidden then; without one nothing says so."""
    return not App.GuiUp and any(user.isDerivedFrom("App::Link") and any(_is_group(group) for group in user.InList)
                                 for user in thing.InList)


def _is_root(thing):
    return not _is_consumed(thing) and not _is_template(thing) and not any(_is_group(user) for user in thing.InList)


def _has_parts(thing):
    """Is it a group, a link to one, or a link with several elements?"""
    return _is_group(thing.getLinkedObject(True)) or getattr(thing, "ElementCount", 0) > 0


def _solid_shape(root, path):
    """The shape where it stands in the document, or None where there is no solid."""
    try:
        shape = Part.getShape(root, path, needSubElement=False, transform=True)
    except Exception:  # whatever an object of another add-on raises: it has no shape
        return None
    return None if shape.isNull() or not shape.Solids else shape.copy()


def _walk(things, path, labels, shown_only):
    thing = things[-1]
    if thing.Name == MARK or (shown_only and not thing.Visibility):
        return
    if not _has_parts(thing):
        shape = _solid_shape(things[0], path)
        solids = shape.Solids if shape is not None else []
        # FreeCAD may read a whole assembly as one object.
        if len(solids) > 1 and thing.TypeId == "Part::Feature":
            for number, solid in enumerate(solids, 1):
                yield Body(things, f"{path}Solid{number}", labels[:-1] + [f"{labels[-1]} {number}"], solid)
        elif solids:
            yield Body(things, path, labels, shape)
        return
    for sub in thing.getSubObjects():
        inner = things[0].getSubObject(path + sub, retType=1)
        if inner is None or (_is_consumed(inner) and not getattr(thing, "ElementCount", 0)):
            continue
        if shown_only and thing.isElementVisible(sub.rstrip(".")) == 0:
            continue
        if sub[0].isdigit():  # an element of a link: the linked object, which is itself hidden as a rule
            number = str(int(sub.rstrip(".")) + 1)
            yield from _walk(things + [inner], path + sub, labels[:-1] + [labels[-1] + " " + number], False)
        else:
            yield from _walk(things + [inner], path + sub, labels + [inner.Label], shown_only)


def _named(bodies):
    """Names of STEP, of labels; the assembly that holds all of them is in no name."""
    if len({body.root.Name for body in bodies}) == 1 and all(len(body.labels) > 1 for body in bodies):
        for body in bodies:
            body.labels = body.labels[1:]
    taken = set()
    for body in bodies:
        stem = name = re.sub(r"[^\w-]+", "_", "_".join(body.labels)) or "body"
        number = 1
        while name in taken:
            number += 1
            name = f"{stem}_{number}"
        taken.add(name)
        body.name = name
    return bodies


def bodies_of(document, selection=()):
    """What is checked: the selection, groups and links opened, or else every visible solid of the document that is not a step
    towards another one. A list of Body."""
    bodies = [body for thing in document.Objects if _is_root(thing)
              for body in _walk([thing], "", [thing.Label], not selection)]
    if selection:
        names = {thing.Name for thing in selection}
        bodies = [body for body in bodies if names & {thing.Name for thing in body.things}]
        found = {thing.Name for body in bodies for thing in body.things}
        for thing in selection:  # what lies in no body: a step towards one
            if thing.Name not in found:
                bodies += _walk([thing], "", [thing.Label], False)
    return _named(bodies)


def export_step(bodies, file):
    """Writes the bodies as an assembly in which each has its name."""
    active = App.ActiveDocument
    scratch = App.newDocument("mortise_export", hidden=True)
    try:
        copies = []
        for body in bodies:
            copy = scratch.addObject("Part::Feature", "Body")
            copy.Shape = body.shape
            copy.Label = body.name
            copies.append(copy)
        scratch.recompute()
        Import.export(copies, file)
    finally:
        App.closeDocument(scratch.Name)
        if active is not None:
            App.setActiveDocument(active.Name)
    if not os.path.exists(file):
        raise RuntimeError(f"{file}: FreeCAD wrote no STEP file")
