"""Plug-ins: from a name, a class, a function or an object to what does the work, for every kind in the same way.

`registry` makes one of what is given, by the `contract` of its kind. `importing` finds those of modules and files.
"""

from trundle.registry.contract import Contract as Contract
from trundle.registry.contract import CopiedAsNew as CopiedAsNew
from trundle.registry.contract import PluginFunction as PluginFunction
from trundle.registry.contract import is_foreign as is_foreign
from trundle.registry.contract import keywords_taken as keywords_taken
from trundle.registry.contract import name_of as name_of
from trundle.registry.importing import PYTHON as PYTHON
from trundle.registry.importing import is_model_file as is_model_file
from trundle.registry.importing import is_plugin_file as is_plugin_file
from trundle.registry.importing import without_files as without_files
from trundle.registry.registry import Registry as Registry
from trundle.registry.registry import offered_arguments as offered_arguments
