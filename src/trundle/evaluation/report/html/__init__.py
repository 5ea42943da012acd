"""`report.html`: one file without scripts or requests, for screens and paper."""
