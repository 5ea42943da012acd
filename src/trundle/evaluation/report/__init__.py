"""The reports of an evaluation for people and for CI: report.html, junit.xml, summary.json and tables of text."""
