"""Writing results so that nothing half-written is ever left, and nothing of others is lost."""

from horizon_dl.output.files import replacing, write_bytes, write_json, write_text
from horizon_dl.output.folder import output_folder

__all__ = ["output_folder", "replacing", "write_bytes", "write_json", "write_text"]
