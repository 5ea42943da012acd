"""The page in a browser: a server that shows runs to many pages, and lets one of them drive."""
