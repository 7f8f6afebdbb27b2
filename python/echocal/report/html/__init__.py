"""A diagnosis as one page for a browser, a phone or a printer."""

from echocal.report.html.page import report_page, save_report

__all__ = ["report_page", "save_report"]
