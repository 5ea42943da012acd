"""Observers that record: run folders, pictures, videos, and a progress bar."""
