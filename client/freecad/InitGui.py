"""The workbench: two commands. FreeCAD runs this file when it starts."""

import FreeCADGui as Gui


class MortiseWorkbench(Gui.Workbench):
    MenuText = "mortise"
    ToolTip = "What really clashes in the open assembly"

    def Initialize(self):
        from mortise_freecad import commands
        names = commands.register()
        self.appendToolbar("mortise", names)
        self.appendMenu("mortise", names)

    def GetClassName(self):
        return "Gui::PythonWorkbench"


Gui.addWorkbench(MortiseWorkbench())
