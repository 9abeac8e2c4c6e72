"""The list of clashes beside the model."""

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

from .bodies import MARK

COLUMNS = ("class", "parts", "relation", "depth")
COLOURS = {"real": "#b3261e", "potential": "#9a6700", "fake": "#1f6feb", "contact": "#57606a", "none": "#57606a"}


def _cells(found):
    word = found.collision_class + (" (explained)" if found.explained else "")
    return word, f"{found.a.label} × {found.b.label}", found.relation, found.depth_text()


def show(found):
    """Selects both parts, marks the place, which is drawn before them, and looks at it."""
    Gui.Selection.clearSelection()
    for body in (found.a, found.b):
        Gui.Selection.addSelection(body.root.Document.Name, body.root.Name, body.path)
    if found.point is None:
        Gui.SendMsgToActiveView("ViewSelection")
        return
    document = found.a.root.Document
    mark = document.getObject(MARK) or document.addObject("Part::Sphere", MARK)
    mark.Radius = max(0.5, 0.02 * min(body.shape.BoundBox.DiagonalLength for body in (found.a, found.b)))
    mark.Placement.Base = found.point
    mark.ViewObject.ShapeColor = (0.70, 0.15, 0.12)
    mark.ViewObject.OnTopWhenSelected = "Object"
    mark.recompute()
    Gui.Selection.addSelection(mark)
    Gui.SendMsgToActiveView("ViewSelection")


class ClashPanel(QtGui.QDockWidget):
    def __init__(self, report):
        super().__init__("Clashes", Gui.getMainWindow())
        self.report = report
        counts = report.counts
        head = QtGui.QLabel(f"{counts['unexplained_real']} unexplained real, {counts['explained_real']} explained real, "
                            f"{counts['potential']} potential, {counts['contacts']} contacts")
        self.table = QtGui.QTableWidget(len(report.found), len(COLUMNS))
        self.table.setHorizontalHeaderLabels(COLUMNS)
        self.table.setSelectionBehavior(QtGui.QAbstractItemView.SelectRows)
        self.table.setEditTriggers(QtGui.QAbstractItemView.NoEditTriggers)
        for row, found in enumerate(report.found):
            for column, text in enumerate(_cells(found)):
                item = QtGui.QTableWidgetItem(text)
                item.setToolTip(found.why)
                if column == 0:
                    item.setForeground(QtGui.QColor(COLOURS["fake" if found.explained else found.collision_class]))
                self.table.setItem(row, column, item)
        self.table.resizeColumnsToContents()
        self.table.itemSelectionChanged.connect(self.show_row)
        inside = QtGui.QWidget()
        layout = QtGui.QVBoxLayout(inside)
        layout.addWidget(head)
        layout.addWidget(self.table)
        self.setWidget(inside)
        Gui.getMainWindow().addDockWidget(QtCore.Qt.RightDockWidgetArea, self)

    def show_row(self):
        row = self.table.currentRow()
        if row >= 0:
            show(self.report.found[row])
