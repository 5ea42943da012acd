"""Learned policies in ONNX files, as agents."""
