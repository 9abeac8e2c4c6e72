"""The commands of the workbench."""

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtGui

from . import bodies, check

_kept = []  # panels and sessions, so that they live as long as FreeCAD


def _say(error):
    QtGui.QMessageBox.warning(Gui.getMainWindow(), "mortise", str(error))


def _chosen():
    return bodies.bodies_of(App.ActiveDocument, Gui.Selection.getSelection())


class CheckClashes:
    def GetResources(self):
        return {"MenuText": "Check clashes", "ToolTip": "What really clashes in the selection, or in the whole document"}

    def IsActive(self):
        return App.ActiveDocument is not None

    def Activated(self):
        from .panel import ClashPanel
        try:
            report = check.run(_chosen())
        except check.CheckError as error:
            _say(error)
            return
        _kept.append(ClashPanel(report))


class OpenSession:
    def GetResources(self):
        return {"MenuText": "Open shared session", "ToolTip": "A live session on the selection, or on the whole document (mortise open)"}

    def IsActive(self):
        return App.ActiveDocument is not None

    def Activated(self):
        try:
            session, file = check.open_session(_chosen())
        except check.CheckError as error:
            _say(error)
            return
        _kept.append(session)
        App.Console.PrintMessage(f"mortise: a session on {file} has started; its addresses are in the folder sessions beside it\n")


def register():
    for name, command in (("Mortise_Check", CheckClashes()), ("Mortise_Open", OpenSession())):
        Gui.addCommand(name, command)
    return ["Mortise_Check", "Mortise_Open"]
