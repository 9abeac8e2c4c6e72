"""The bodies of a document that are checked, and their STEP file. Needs no screen."""

import os

import FreeCAD as App
import Import
import Part

MARK = "MortisePlace"  # the object that shows a place: never checked itself
_GROUPS = ("App::Part", "App::DocumentObjectGroup", "App::LinkGroup", "Assembly::AssemblyObject")


def _solid_shape(thing):
    """The shape of an object where it stands in the document, or None where it has no solid."""
    try:
        shape = Part.getShape(thing, "", needSubElement=False, transform=False)
    except Exception:  # whatever an object of another add-on raises: it has no shape
        return None
    if shape.isNull() or not shape.Solids:
        return None
    shape = shape.copy()
    shape.Placement = thing.getGlobalPlacement() if hasattr(thing, "getGlobalPlacement") else thing.Placement
    return shape


def _is_group(thing):
    return thing.TypeId in _GROUPS or thing.isDerivedFrom("App::DocumentObjectGroup")


def _is_consumed(thing):
    """Is it a step towards another body: a feature of a PartDesign body, or an operand of a Boolean?"""
    return any(not _is_group(user) and hasattr(user, "Shape") and not user.isDerivedFrom("App::Link") and user.Shape.Solids
               for user in thing.InList)


def _below(thing):
    if not _is_group(thing):
        return [thing]
    return [inner for child in thing.Group for inner in _below(child)]


def bodies_of(document, selection=()):
    """What is checked: the selection, groups opened, or else every visible solid of the document that is not a step towards
    another one. A list of (object, shape)."""
    things = [inner for thing in selection for inner in _below(thing)] if selection else list(document.Objects)
    bodies, seen = [], set()
    for thing in things:
        if thing.Name in seen or thing.Name == MARK or _is_group(thing) or (not selection and _is_consumed(thing)):
            continue
        seen.add(thing.Name)
        if not selection and App.GuiUp and not thing.ViewObject.Visibility:
            continue
        shape = _solid_shape(thing)
        if shape is not None:
            bodies.append((thing, shape))
    return bodies


def export_step(bodies, file):
    """Writes the bodies as an assembly in which each has the name of its object, which is unique in the document."""
    active = App.ActiveDocument
    scratch = App.newDocument("mortise_export", hidden=True)
    try:
        copies = []
        for thing, shape in bodies:
            copy = scratch.addObject("Part::Feature", "Body")
            copy.Shape = shape
            copy.Label = thing.Name
            copies.append(copy)
        scratch.recompute()
        Import.export(copies, file)
    finally:
        App.closeDocument(scratch.Name)
        if active is not None:
            App.setActiveDocument(active.Name)
    if not os.path.exists(file):
        raise RuntimeError(f"{file}: FreeCAD wrote no STEP file")
