"""run_notebook.py FILE.ipynb: its code cells, one after the other, as a person runs them in Jupyter."""
import json
import sys

notebook = json.load(open(sys.argv[1], encoding="utf-8"))
assert notebook["nbformat"] == 4, notebook["nbformat"]
names = {}
ran = 0
for number, cell in enumerate(notebook["cells"]):
    assert not cell.get("outputs"), f"cell {number}: results of somebody's run are kept in it"
    if cell["cell_type"] == "code":
        exec(compile("".join(cell["source"]), f"cell {number}", "exec"), names)  # a traceback names the cell
        ran += 1
assert ran > 0, "no code"
print(f"{ran} cells ran")
