"""Code shared by several verbs: options, interpretation of arguments, printing of results, Isaac Sim."""
