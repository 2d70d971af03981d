"""From a trained net to one ONNX file."""
