"""Plug-ins: from a name, a class, a function or an object to what does the work, for every kind in the same way."""

from trundle.registry.registry import PYTHON as PYTHON
from trundle.registry.registry import Contract as Contract
from trundle.registry.registry import CopiedAsNew as CopiedAsNew
from trundle.registry.registry import PluginFunction as PluginFunction
from trundle.registry.registry import Registry as Registry
from trundle.registry.registry import is_foreign as is_foreign
from trundle.registry.registry import is_plugin_file as is_plugin_file
from trundle.registry.registry import keywords_taken as keywords_taken
from trundle.registry.registry import name_of as name_of
from trundle.registry.registry import offered_arguments as offered_arguments
from trundle.registry.registry import without_files as without_files
