"""What several verbs share: their options, what their arguments stand for, how results are printed, Isaac Sim."""
