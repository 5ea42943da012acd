"""What an evaluation says to people and to CI: report.html, junit.xml, summary.json and tables of text."""
