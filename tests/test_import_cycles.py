"""No module of the package imports itself through others; imports inside functions and for types count as well."""

import itertools
from graphlib import CycleError, TopologicalSorter

import grimp


def find_cycle(graph):
    """The modules of one import cycle in the order of their imports, the first one again at the end; [] without one."""
    sorter = TopologicalSorter({name: graph.find_modules_directly_imported_by(name) for name in graph.modules})
    try:
        sorter.prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return []


def test_modules_do_not_import_each_other_in_a_cycle():
    graph = grimp.build_graph("trundle", cache_dir=None)
    assert graph.find_modules_directly_imported_by("trundle.maps.grid"), "the graph has no imports"
    cycle = find_cycle(graph)
    assert not cycle, " -> ".join(cycle)


def test_a_cycle_is_found_with_its_modules():
    graph = grimp.ImportGraph()
    for name in ("top", "a", "b", "c"):
        graph.add_module(name)
    for importer, imported in (("top", "a"), ("a", "b"), ("b", "c"), ("c", "a")):
        graph.add_import(importer=importer, imported=imported)
    cycle = find_cycle(graph)
    assert len(cycle) == 4
    assert set(cycle) == {"a", "b", "c"}
    assert cycle[0] == cycle[-1]
    assert all(graph.direct_import_exists(importer=first, imported=next_) for first, next_ in itertools.pairwise(cycle))
