"""The images of maps: PNG, BMP and PNM, read and written."""
